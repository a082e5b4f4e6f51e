#pragma once

// Templates filled with values. Only for sources that use mustache.

#include <kainjow/mustache.hpp>

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

namespace hshfit::inline files {

/// A template of source text (shaders, scripts) with its values as they are. Throws std::bad_alloc
/// where memory is short; the render() of mustache itself, which writes to a stream, would end the
/// text there without a word.
std::string filledText(std::string_view text, const kainjow::mustache::data& values);

/// A page or a script of gnuplot: the values are escaped for HTML unless the template says
/// otherwise, and the lines are printable (printable.h).
std::string filledPage(std::string_view text, const kainjow::mustache::data& values);

/// Templates as the partials of those names. The last newline of each is dropped, because the line
/// that names a partial has one of its own.
void setPartials(std::initializer_list<std::pair<const char*, std::string_view>> parts,
                 kainjow::mustache::data& page);

}  // namespace hshfit::inline files
