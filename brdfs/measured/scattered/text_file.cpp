#include <brdfs/measured/foreign.h>
#include <brdfs/measured/scattered/scattered.h>
#include <brdfs/measured/scattered/text_file.h>
#include <hshfit/files/mapped_file.h>

#include <fmt/format.h>

namespace hshfit::brdfs {

void withTextFile(const std::string& path,
                  const std::function<void(std::string_view, const std::string&)>& read) {
    const MappedFile file(path);
    try {
        const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
        read(withoutByteOrderMark(text), path);
    } catch (const InputError&) {
        file.checkIntact();
        throw;
    }
    file.checkIntact();
}

namespace {

std::unique_ptr<Brdf> openSamples(
    const std::string& path, const Parameters& parameters,
    const std::function<Samples(std::string_view, const std::string&)>& read,
    ScatteredOptions::Tables tables) {
    Samples samples;
    withTextFile(path, [&](std::string_view text, const std::string& where) {
        samples = read(text, where);
    });
    std::string words = parameters.canonical();
    ScatteredOptions options = scatteredOptions(parameters);
    options.tables = tables;
    if (!samples.side.empty()) {
        // Directions of a transmission are not exchanged, and its name states its side.
        options.exchange = options.exchange && !samples.side.starts_with("transmission");
        if (parameters.choice("side") == "auto" && samples.side != "reflection-front")
            words += fmt::format("{}side={}", words.empty() ? "" : ",", samples.side);
    }
    return std::make_unique<Scattered>(std::move(samples), options,
                                       words.empty() ? path : path + ":" + words);
}

}  // namespace

std::unique_ptr<Brdf> openScattered(
    const std::string& path, const Parameters& parameters,
    const std::function<Samples(std::string_view, const std::string&)>& read) {
    return openSamples(path, parameters, read, ScatteredOptions::Tables::none);
}

std::unique_ptr<Brdf> openTables(
    const std::string& path, const Parameters& parameters,
    const std::function<Samples(std::string_view, const std::string&)>& read) {
    return openSamples(path, parameters, read, ScatteredOptions::Tables::aboutNormal);
}

std::string_view asText(std::span<const unsigned char> head) {
    const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
    return text.find('\0') == std::string_view::npos ? text : std::string_view();
}

std::string_view firstLine(std::string_view text) {
    return text.substr(0, text.find_first_of("\r\n"));
}

std::string lowerCase(std::string_view text) {
    std::string lower(text);
    for (char& c : lower)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return lower;
}

std::string_view withoutBlanks(std::string_view text) {
    const std::size_t begin = text.find_first_not_of(" \t");
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

}  // namespace hshfit::brdfs
