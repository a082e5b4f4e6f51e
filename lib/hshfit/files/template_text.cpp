#include <hshfit/files/printable.h>
#include <hshfit/files/template_text.h>

// The general one of the library reads a stream, which takes short memory for the end of a name.
template <>
inline std::vector<std::string> kainjow::mustache::split(const std::string& name, char delimiter) {
    std::vector<std::string> parts;
    for (std::size_t from = 0; from < name.size();) {
        const std::size_t end = std::min(name.find(delimiter, from), name.size());
        parts.push_back(name.substr(from, end - from));
        from = end + 1;
    }
    return parts;
}

namespace hshfit::inline files {
namespace {

using kainjow::mustache::data;
using kainjow::mustache::mustache;

std::string filled(mustache& form, const data& values) {
    std::string result;
    form.render(values, [&result](const std::string& piece) { result += piece; });
    return result;
}

}  // namespace

std::string filledText(std::string_view text, const data& values) {
    mustache form{std::string(text)};
    form.set_custom_escape([](const std::string& value) { return value; });
    return filled(form, values);
}

std::string filledPage(std::string_view text, const data& values) {
    mustache form{std::string(text)};
    return printableLines(filled(form, values));
}

void setPartials(std::initializer_list<std::pair<const char*, std::string_view>> parts,
                 data& page) {
    for (const auto& [name, text] : parts) {
        std::string part(text);
        if (part.ends_with('\n')) part.pop_back();
        page.set(name, data(kainjow::mustache::partial([part] { return part; })));
    }
}

}  // namespace hshfit::inline files
