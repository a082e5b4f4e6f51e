#pragma once

#include <brdfs/measured/scattered/samples.h>
#include <brdfs/rows/spec.h>

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace hshfit::brdfs {

/// Calls `read` with the whole text of a file and its path, and checks that the file did not change
/// meanwhile.
void withTextFile(const std::string& path,
                  const std::function<void(std::string_view, const std::string&)>& read);

/// A file of scattered samples with the options that its row of the table of formats declares.
std::unique_ptr<Brdf> openScattered(
    const std::string& path, const Parameters& parameters,
    const std::function<Samples(std::string_view, const std::string&)>& read);

/// The first bytes of a file as text; empty if there is a 0 among them.
std::string_view asText(std::span<const unsigned char> head);

/// The line that starts at the front of `text`, without its end (LF, CR LF or CR).
std::string_view firstLine(std::string_view text);

/// ASCII letters in lower case.
std::string lowerCase(std::string_view text);

/// The text without blanks and tabs at its ends.
std::string_view withoutBlanks(std::string_view text);

}  // namespace hshfit::brdfs
