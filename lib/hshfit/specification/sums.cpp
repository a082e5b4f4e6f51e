#include <hshfit/specification/sums.h>

#include <cctype>

namespace hshfit::inline specification {
namespace {

/// Whether the '+' at `at` belongs to a number such as 1e+3 or, as no number may begin, kd=+1.
bool inNumber(std::string_view text, std::size_t at) {
    if (at >= 1 && std::string_view("=/,").find(text[at - 1]) != std::string_view::npos)
        return true;
    const auto digit = [&](std::size_t k) {
        return k < text.size() && std::isdigit(static_cast<unsigned char>(text[k])) != 0;
    };
    return at >= 2 && (text[at - 1] == 'e' || text[at - 1] == 'E') && digit(at + 1) &&
           (digit(at - 2) || text[at - 2] == '.');
}

}  // namespace

std::size_t nextJoint(std::string_view text, std::size_t from) {
    std::size_t at = text.find('+', from);
    while (at != std::string_view::npos && inNumber(text, at)) at = text.find('+', at + 1);
    return at;
}

std::string_view withoutSpaces(std::string_view text) {
    while (text.starts_with(' ')) text.remove_prefix(1);
    while (text.ends_with(' ')) text.remove_suffix(1);
    return text;
}

}  // namespace hshfit::inline specification
