#include <brdfs/measured/foreign.h>
#include <brdfs/measured/scattered/text_file.h>
#include <brdfs/measured/text_reader.h>
#include <hshfit/error.h>
#include <hshfit/files/json_format.h>

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {
namespace {

constexpr std::string_view likeNumbers =
    "a table of numbers without the names of its columns; put a line of names before it, such as "
    "theta_i,phi_i,theta_o,phi_o,brdf";

/// Files by their first bytes.
struct Magic {
    std::string_view bytes, what;
};

constexpr Magic magics[] = {
    {"version https://git-lfs",
     "a Git LFS pointer, not the file itself; fetch that with "
     "'git lfs pull'"},
    {"\x1f\x8b", "compressed (gzip); unpack it first"},
    {"BZh", "compressed (bzip2); unpack it first"},
    {"\xfd"
     "7zXZ",
     "compressed (xz); unpack it first"},
    {"7z\xbc\xaf", "a 7-Zip archive; unpack it first"},
    {"Rar!", "a RAR archive; unpack it first"},
    {"\xd0\xcf\x11\xe0", "an Excel or other Office file; save the table as CSV"},
    {"%PDF", "a PDF document, not data"},
    {"\x89PNG", "a PNG picture, not a BRDF"},
    {"\xff\xd8\xff", "a JPEG picture, not a BRDF"},
    {"GIF8", "a GIF picture, not a BRDF"},
    {"#?RADIANCE", "a Radiance picture, which is light, not a BRDF"},
    {"\x89HDF", "an HDF5 file (newer MATLAB files are of this kind); export the table as CSV"},
    {"MATLAB 5.0", "a MATLAB file; export the table as CSV"},
    {"CDF\x01", "a NetCDF file; export the table as CSV"},
    {"\x93NUMPY", "a NumPy array; export the table as CSV"},
    {"PAR1", "a Parquet file; export the table as CSV"},
};

/// Whether the text begins with the byte-order mark of UTF-16, and every other byte is 0 as in
/// Latin letters and digits.
bool isUtf16(std::string_view text) {
    const bool little = text.starts_with("\xff\xfe"), big = text.starts_with("\xfe\xff");
    if (!little && !big) return false;
    constexpr std::size_t most = 32;
    const std::size_t end = std::min(text.size() & ~std::size_t{1}, most);
    for (std::size_t k = 2; k + 1 < end; k += 2)
        if (text[little ? k : k + 1] == 0 || text[little ? k + 1 : k] != 0) return false;
    return end > 2;
}

std::optional<std::string> archiveOf(std::string_view text) {
    if (!text.starts_with("PK\x03\x04")) return std::nullopt;
    if (text.find("[Content_Types].xml") != std::string_view::npos ||
        text.find("xl/") != std::string_view::npos)
        return "an Excel workbook; save the table as CSV";
    return "a ZIP archive; unpack it first";
}

bool isWebPage(std::string_view lower) {
    const std::size_t first = lower.find_first_not_of(" \t\r\n\xef\xbb\xbf");
    if (first == std::string_view::npos) return false;
    lower.remove_prefix(first);
    return lower.starts_with("<!doctype html") || lower.starts_with("<html") ||
           (lower.starts_with("<") && lower.find("<html") < 1000);
}

/// A short answer of a server in place of a file: "404: Not Found".
bool isServerError(std::string_view lower) {
    if (lower.size() > 400) return false;
    for (const std::string_view words : {"not found", "access denied", "forbidden", "bad gateway",
                                         "accessdenied", "nosuchkey", "rate limit"})
        if (lower.find(words) != std::string_view::npos) return true;
    return false;
}

/// Whether the first lines that are no remarks hold two or more numbers each and nothing else.
bool isTableOfNumbers(std::string_view text, bool whole) {
    TextReader reader(text, "");
    std::vector<double> row;
    std::size_t rows = 0;
    while (rows < 3 && reader.next()) {
        const std::string_view line = withoutBlanks(reader.line());
        if (line.empty() || line[0] == '#' || line[0] == '%') continue;
        // The last line of the head may be incomplete.
        if (!whole && reader.line().end() == text.end()) break;
        try {
            reader.takeNumbers(row, line.find(';') != std::string_view::npos ? ';' : ',');
        } catch (const InputError&) {
            return false;
        }
        if (row.size() < 2) return false;
        ++rows;
    }
    return rows > 0;
}

/// Text of programs whose tables are not read.
std::optional<std::string> programOf(std::string_view text, std::string_view lower) {
    const auto has = [&](std::string_view word) {
        return lower.find(word) != std::string_view::npos;
    };
    if (text.starts_with("OPTIS - "))
        return "a Speos file of another kind; .brdf and .anisotropicbsdf are read, as text";
    if (has("\naoi") && has("\npoi"))
        return "a LightTools BSDF, whose layout is not public; export it as Zemax BSDF or as a "
               "table";
    if (has("windowelement") || lower.starts_with("<?xml"))
        return "XML, but no BSDF XML: that begins with <WindowElement>";
    return std::nullopt;
}

}  // namespace

std::string_view withoutByteOrderMark(std::string_view text) {
    constexpr std::string_view mark = "\xef\xbb\xbf";
    return text.starts_with(mark) ? text.substr(mark.size()) : text;
}

bool isPlainText(std::span<const unsigned char> head) {
    return std::ranges::none_of(head, [](unsigned char c) {
        return (c < 32 && c != '\t' && c != '\n' && c != '\r' && c != '\f') || c == 127;
    });
}

std::optional<std::string> foreignContent(std::span<const unsigned char> head, bool certain) {
    const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
    const std::string lower = lowerCase(text);
    if (isWebPage(lower))
        return "a web page; download the file itself (its raw form), not the page that shows it";
    if (certain) return std::nullopt;
    for (const Magic& magic : magics)
        if (text.starts_with(magic.bytes)) return std::string(magic.what);
    if (isUtf16(text)) return "text in UTF-16; save it as UTF-8";
    if (auto archive = archiveOf(text)) return archive;
    if (beginsAsJson(text))
        return "JSON of another program; tables of OpenMATERIAL (.xompt) and this program's own "
               "files are read";
    if (!isPlainText(head)) return std::nullopt;
    if (isServerError(lower)) return "the error message of a server; download the file again";
    if (auto program = programOf(text, lower)) return program;
    if (isTableOfNumbers(text, head.size() < 4096)) return std::string(likeNumbers);
    return std::nullopt;
}

}  // namespace hshfit::brdfs
