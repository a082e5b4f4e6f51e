#include "named_files.h"

#include <hshfit/files/json_format.h>
#include <hshfit/gpu/containers/sidecar.h>
#include <hshfit/specification/parameters.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace hshfit::jobs {
namespace {

namespace fs = std::filesystem;

/// Names stand at the beginning and at the end of long files, whose middle is numbers.
constexpr std::uintmax_t whole = std::uintmax_t{1} << 24, edge = std::uintmax_t{1} << 16;

std::string piece(std::ifstream& file, std::uintmax_t from, std::uintmax_t count) {
    std::string text(count, '\0');
    file.clear();
    file.seekg(static_cast<std::streamoff>(from));
    file.read(text.data(), static_cast<std::streamsize>(count));
    text.resize(static_cast<std::size_t>(file.gcount()));
    return text;
}

/// The text between quotes of a JSON file; empty for any other file.
std::string textOfJson(const std::string& path) {
    std::error_code error;
    const std::uintmax_t size = fs::file_size(path, error);
    std::ifstream file(path, std::ios::binary);
    if (error || !file) return {};
    const std::string head = piece(file, 0, std::min(size, edge));
    if (!beginsAsJson(head)) return {};
    if (size <= whole) return piece(file, 0, size);
    return head + "\n" + piece(file, size - edge, edge);
}

void addAt(std::string_view text, const fs::path& folder, std::set<std::string>& files);

void addFile(const std::string& path, std::set<std::string>& files) {
    if (!files.insert(path).second) return;
    std::error_code error;
    const fs::path sidecar = gpu::sidecarBeside(path);
    if (fs::is_regular_file(sidecar, error)) addFile(sidecar.string(), files);
    const std::string text = textOfJson(path);
    const fs::path folder = fs::path(path).parent_path();
    for (std::size_t begin = text.find('"'); begin != std::string::npos;) {
        std::size_t end = text.find_first_of("\"\n", begin + 1);
        while (end != std::string::npos && text[end] == '"' && text[end - 1] == '\\')
            end = text.find_first_of("\"\n", end + 1);
        if (end == std::string::npos) break;
        const std::string_view word(text.data() + begin + 1, end - begin - 1);
        constexpr std::size_t longest = 4096;
        if (text[end] == '"' && !word.empty() && word.size() <= longest) addAt(word, folder, files);
        begin = text.find('"', end + 1);
    }
}

/// The file that a specification names, seen from a folder or from the current one.
bool addSpecification(std::string_view part, const fs::path& folder, std::set<std::string>& files) {
    std::error_code error;
    const auto add = [&](const std::string& seen) {
        const std::string path(pathIn(seen));
        if (path.empty()) return false;
        if (fs::is_regular_file(path, error)) addFile(path, files);
        return true;
    };
    const bool relative = !folder.empty() && fs::path(part).is_relative();
    return (relative && add((folder / part).string())) || add(std::string(part));
}

void addAt(std::string_view text, const fs::path& folder, std::set<std::string>& files) {
    if (text.empty() || addSpecification(text, folder, files)) return;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find_first_of("+,", begin), text.size());
        std::string_view part = text.substr(begin, end - begin);
        while (part.starts_with(' ')) part.remove_prefix(1);
        while (part.ends_with(' ')) part.remove_suffix(1);
        // The file is left by a prefix that changes what is read, "grey:FILE", and by a weight,
        // "0.5 * FILE", and by the key of a file, "perez:file=FILE".
        while (!part.empty() && !addSpecification(part, folder, files)) {
            const std::size_t mark = part.find_first_of(":*=");
            if (mark == std::string_view::npos) break;
            part.remove_prefix(mark + 1);
            while (part.starts_with(' ')) part.remove_prefix(1);
        }
        begin = end + 1;
    }
}

}  // namespace

void addNamedFiles(std::string_view text, std::set<std::string>& files) {
    addAt(text, {}, files);
}

}  // namespace hshfit::jobs
