#pragma once

#include <hshfit/error.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// Reads a text file of numbers line by line, in place. Lines end in LF, CR LF or CR.
/// Numbers are read as by std::from_chars (independent of the locale), with an optional "+", and
/// "nan" and "inf" in any case. A number that overflows a double is read as infinite, one that
/// underflows as 0.
class TextReader {
public:
    /// `text` has to outlive the reader; `where` (a path) starts every message.
    TextReader(std::string_view text, std::string where);

    /// Moves to the next line; false at the end. The line is without its end.
    bool next();
    std::string_view line() const { return line_; }
    std::size_t lineNumber() const { return number_; }  ///< 1 for the first
    bool blank() const;                                 ///< the line holds only blanks

    /// Takes the next number of the line. False at its end. Blanks, tabs and at most one of
    /// `separator` (0: none) stand between numbers. Throws InputError where something else stands.
    bool takeNumber(double& value, char separator = 0);
    /// Takes the next word of the line (up to a blank); empty at its end.
    std::string_view takeWord();
    /// Takes the whole line as numbers, which replace the contents of `values`.
    void takeNumbers(std::vector<double>& values, char separator = 0);

    /// "PATH: line N: MESSAGE".
    InputError error(std::string_view message) const;

private:
    void skipBlanks();

    std::string where_;
    std::string_view rest_;       ///< after the line
    const char* feed_ = nullptr;  ///< the next LF at or after the start of rest_, or its end
    std::string_view line_;
    std::string_view ahead_;  ///< of the line, not yet taken
    std::size_t number_ = 0;
    bool first_ = true;  ///< no number was taken from this line yet
};

/// Takes one number off the front of `text` as above; false if none stands there.
bool takeNumber(std::string_view& text, double& value);

}  // namespace hshfit::brdfs
