#pragma once

#include <string>
#include <string_view>

namespace hshfit::inline files {

/// The path of standard input.
inline constexpr std::string_view standardInputPath = "/dev/stdin";

/// A path through which all of standard input can be read, again and at any place, like a file.
/// A pipe is first read to its end, into memory. Throws InputError if standard input is closed, a
/// terminal or empty.
std::string standardInput();

/// A path that AtomicFile, and through it every writer, takes for standard output, as a file of
/// this extension: the bytes go out once they are complete. ".json": "/dev/stdout.json".
std::string standardOutput(std::string_view extension);
bool isStandardOutput(std::string_view path);

/// A file in memory for what will be sent to standard output; its path, which other processes can
/// open too. There is one at a time. Throws OutputError if there is one.
std::string openOutputBuffer();
/// Copies it to standard output. Returns the system's error, 0 for none.
int sendOutputBuffer() noexcept;
void closeOutputBuffer() noexcept;

}  // namespace hshfit::inline files
