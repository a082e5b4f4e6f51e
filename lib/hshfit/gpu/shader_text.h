#pragma once

#include <string>
#include <string_view>

namespace hshfit::gpu {

/// Text for a comment: printable ASCII on one line, so that nothing can end the comment.
std::string commentText(std::string text);
/// The same for the specification of what a shader evaluates, with the meaning of wo where it is a
/// transmission.
std::string sourceComment(const std::string& specification);

/// Text within the backquotes of a JavaScript template.
std::string backquoted(std::string_view text);

/// Throws UsageError for a prefix that no shading language takes for the beginning of a name.
void checkPrefix(const std::string& prefix);

/// Omitted sections leave blank lines behind. One is kept before each line that starts at the
/// margin.
std::string withoutGaps(const std::string& text);

}  // namespace hshfit::gpu
