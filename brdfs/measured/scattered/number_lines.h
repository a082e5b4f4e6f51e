#pragma once

#include <brdfs/measured/text_reader.h>

#include <cstddef>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// Numbers of a text that may go on over lines, between blanks; for tables whose sizes are
/// announced.
class NumberLines {
public:
    /// `reader` has to outlive this. `bytes` is the size of the whole text: a bound of the counts.
    NumberLines(TextReader& reader, std::size_t bytes) : reader_(reader), bytes_(bytes) {}

    /// The next line that is not blank and begins with none of `remarks`. Throws InputError at the
    /// end of the file, saying that `what` is missing.
    void nextLine(std::string_view what, std::string_view remarks = "#");
    /// The next number of this line or the next ones.
    double take(std::string_view what);
    /// A whole number from 1, of things that take at least two bytes each.
    std::size_t takeCount(std::string_view what);
    /// `count` finite numbers; ascending: each above the one before it.
    std::vector<double> take(std::size_t count, std::string_view what);
    std::vector<double> takeAscending(std::size_t count, std::string_view what);
    /// Throws InputError if the line has more numbers.
    void endLine(std::string_view what);

private:
    TextReader& reader_;
    std::size_t bytes_;
};

}  // namespace hshfit::brdfs
