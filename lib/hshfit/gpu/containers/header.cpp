// A header for C and C++: the sidecar in a comment, constants, and one array.

#include <hshfit/gpu/containers/internal/byte_fields.h>
#include <hshfit/gpu/containers/internal/container_files.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <utility>

namespace hshfit::gpu::inline containers {
namespace {

constexpr std::string_view magic = "/* hshfit-gpu 1\n";
constexpr std::string_view arrayStart = "[] = {\n";

/// The name with anything but letters, digits and underscores replaced.
std::string identifier(const TexelFile& file) {
    std::string text = fmt::format("{}_{}", file.name, roleName(file.role));
    std::replace_if(
        text.begin(), text.end(),
        [](char c) { return c != '_' && !std::isalnum(static_cast<unsigned char>(c)); }, '_');
    return fmt::format("{}{}", std::isdigit(static_cast<unsigned char>(text[0])) ? "_" : "", text);
}

std::string_view elementType(Number number) {
    switch (number) {
        case Number::float16:
        case Number::unorm16:
            return "uint16_t";
        case Number::float32:
            return "float";
        case Number::unorm8:
            break;
    }
    return "uint8_t";
}

std::string numberText(const Texels& texels, std::size_t i) {
    const std::byte* at = texels.bytes.data() + i * numberBytes(texels.number);
    if (texels.number == Number::float32) {
        float value;
        std::memcpy(&value, at, sizeof value);
        const std::string text = fmt::format("{}", value);
        return fmt::format("{}{}", text, text.find_first_of(".e") == text.npos ? ".f" : "f");
    }
    if (texels.number == Number::unorm8) return fmt::format("{}", std::to_integer<int>(*at));
    std::uint16_t value;
    std::memcpy(&value, at, sizeof value);
    return fmt::format("{:#06x}", value);
}

void write(const TexelFile& file, AtomicFile& out) {
    const Texels& texels = file.texels;
    const std::string name = identifier(file);
    std::string comment = file.sidecar;
    // Equivalent JSON that contains neither the end nor the start of a comment.
    for (const auto& [mark, harmless] :
         {std::pair{std::string_view("*/"), "*\\/"}, {"/*", "/\\u002a"}}) {
        for (std::size_t at = 0; (at = comment.find(mark, at)) != comment.npos;) {
            comment.replace(at, mark.size(), harmless);
        }
    }
    std::string text = fmt::format("{}{}*/\n#ifndef {}_H\n#define {}_H\n\n#include <stdint.h>\n\n",
                                   magic, comment, name, name);
    text += fmt::format("enum {{ {}_width = {}, {}_height = {}, {}_layers = {} }};\n\n", name,
                        texels.width, name, texels.height, name, texels.layers);
    if (!texels.scales.empty()) {
        text += fmt::format(
            "/* value = integer / {} * scale + offset; scale, offset of each layer "
            "and lane */\nstatic const float {}_scale[] = {{\n",
            texels.number == Number::unorm8 ? 255 : 65535, name);
        for (const LaneScale& lane : texels.scales) {
            text += fmt::format("{:a}f, {:a}f,\n", lane.scale, lane.offset);
        }
        text += "};\n\n";
    }
    text += fmt::format("/* {}, index ((layer*height + y)*width + x)*4 + lane */\n",
                        numberName(texels.number));
    text += fmt::format("static const {} {}{}", elementType(texels.number), name, arrayStart);
    constexpr std::size_t perLine = 12;
    for (std::size_t i = 0; i < texels.count(); ++i) {
        text += numberText(texels, i);
        text += i % perLine == perLine - 1 || i + 1 == texels.count() ? ",\n" : ",";
    }
    text += fmt::format("}};\n\n#endif\n");
    out.write(text);
}

std::string sidecar(std::string_view bytes, const std::string& file) {
    const std::size_t end = bytes.find("\n*/\n");
    if (end == bytes.npos) {
        throw InputError(fmt::format("{}: the comment with the sidecar does not end", file));
    }
    return std::string(bytes.substr(magic.size(), end + 1 - magic.size()));
}

/// Reads the numbers that `write` has written, one after the other.
class Numbers {
public:
    Numbers(std::string_view text, Number number, const std::string& file)
        : at_(text.data()), end_(at_ + text.size()), number_(number), file_(file) {}

    void take(std::size_t i, std::byte* out) {
        while (at_ != end_ && (*at_ == '\n' || *at_ == '\r' || *at_ == ' ')) ++at_;
        if (number_ == Number::float32) {
            float value = 0;
            read(i, std::from_chars(at_, end_, value));
            if (at_ != end_ && *at_ == '.') ++at_;
            expect(i, 'f');
            std::memcpy(out, &value, sizeof value);
        } else {
            const bool hexadecimal = end_ - at_ > 2 && at_[0] == '0' && at_[1] == 'x';
            if (hexadecimal) at_ += 2;
            std::uint16_t value = 0;
            read(i, std::from_chars(at_, end_, value, hexadecimal ? 16 : 10));
            if (numberBytes(number_) == 1 && value > 255) fail(i);
            std::memcpy(out, &value, numberBytes(number_));
        }
        expect(i, ',');
    }

private:
    [[noreturn]] void fail(std::size_t i) const {
        throw InputError(fmt::format("{}: number {} of the array is missing or no {}", file_, i,
                                     elementType(number_)));
    }
    void read(std::size_t i, std::from_chars_result result) {
        if (result.ec != std::errc()) fail(i);
        at_ = result.ptr;
    }
    void expect(std::size_t i, char c) {
        if (at_ == end_ || *at_ != c) fail(i);
        ++at_;
    }

    const char *at_, *end_;
    Number number_;
    const std::string& file_;
};

std::vector<std::byte> texels(std::string_view bytes, Role role, const Texels& expected,
                              const std::string& file) {
    const std::string mark = fmt::format("_{}{}", roleName(role), arrayStart);
    const std::size_t start = bytes.find(mark, std::min(bytes.size(), bytes.find("\n*/\n")));
    const std::size_t first = start == bytes.npos ? start : start + mark.size();
    const std::size_t end = first == bytes.npos ? first : bytes.find("};", first);
    if (end == bytes.npos) {
        throw InputError(fmt::format("{}: has no array '…_{}'", file, roleName(role)));
    }
    const std::string_view text = bytes.substr(first, end - first);
    // each takes at least a digit and a comma
    if (expected.count() > text.size() / 2) {
        throw InputError(fmt::format("{}: the array has too few numbers; its sidecar says {}", file,
                                     expected.count()));
    }
    std::vector<std::byte> result(byteCount(expected));
    Numbers numbers(text, expected.number, file);
    const std::size_t size = numberBytes(expected.number);
    for (std::size_t i = 0; i < expected.count(); ++i) numbers.take(i, result.data() + i * size);
    return result;
}

}  // namespace

const Container& headerContainer() {
    static const Container row{
        .name = "h",
        .suffix = ".h",
        .summary = "header for C and C++: an array and its sizes",
        .numbers = {Number::float16, Number::float32, Number::unorm16, Number::unorm8},
        .holdsSidecar = true,
        .write = write,
        .recognises = [](std::string_view bytes) { return bytes.starts_with(magic); },
        .sidecar = sidecar,
        .texels = texels};
    return row;
}

}  // namespace hshfit::gpu::inline containers
