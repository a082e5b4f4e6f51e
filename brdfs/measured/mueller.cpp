#include <brdfs/measured/mueller.h>
#include <hshfit/error.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <string_view>

namespace hshfit::brdfs {
namespace {

/// Row after row, then the degree of polarisation.
constexpr std::string_view known[] = {"m00", "m01", "m02", "m03", "m10", "m11", "m12", "m13", "m20",
                                      "m21", "m22", "m23", "m30", "m31", "m32", "m33", "dolp"};
constexpr std::size_t elements = 16;

std::size_t placeOf(std::string_view name) {
    return static_cast<std::size_t>(std::ranges::find(known, name) - std::begin(known));
}

/// The places of the stated names among the known ones.
std::set<std::size_t> stated(std::string_view text) {
    std::set<std::size_t> places;
    for (std::size_t at = 0; at <= text.size();) {
        const std::size_t end = std::min(text.find('/', at), text.size());
        const std::string_view name = text.substr(at, end - at);
        at = end + 1;
        if (placeOf(name) == std::size(known) || !places.insert(placeOf(name)).second)
            throw UsageError(fmt::format(
                "mueller={}: '{}' is {}; valid: all, or some of {} joined by '/', each once",
                text.substr(0, 100), name.substr(0, 40),
                placeOf(name) == std::size(known) ? "unknown" : "there twice",
                fmt::join(known, ", ")));
    }
    return places;
}

}  // namespace

MuellerElements::MuellerElements(std::string text) : text_(std::move(text)) {
    if (text_ == "all") {
        names_.assign(std::begin(known), std::begin(known) + elements);
        return;
    }
    for (const std::size_t place : stated(text_)) names_.emplace_back(known[place]);
}

bool MuellerElements::arePositive() const {
    for (std::size_t k = 0; k < size(); ++k)
        if (!isPositive(k)) return false;
    return true;
}

std::vector<std::size_t> MuellerElements::places(std::size_t k) const {
    if (names_[k] == "dolp") return {0, 4, 8};
    return {placeOf(names_[k])};
}

std::vector<std::size_t> MuellerElements::places() const {
    std::set<std::size_t> all;
    for (std::size_t k = 0; k < size(); ++k)
        for (const std::size_t place : places(k)) all.insert(place);
    return {all.begin(), all.end()};
}

double MuellerElements::value(std::size_t k, const Matrix& matrix) const {
    if (names_[k] == "m00") return std::max(matrix[0], 0.0);
    if (names_[k] != "dolp") return matrix[placeOf(names_[k])];
    return matrix[0] > 0 ? std::hypot(matrix[4], matrix[8]) / matrix[0] : 0;
}

Channels MuellerElements::channels(Channels wavelengths) const {
    if (isReflectance()) return wavelengths;
    return Channels::named(names_, std::move(wavelengths.wavelengths));
}

Parameter muellerParameter() {
    return {.name = "mueller",
            .help =
                "elements of the Mueller matrices, row and column counted from 0, as channels: "
                "all, or some joined by '/'; dolp: the degree of linear polarisation of what "
                "unpolarised light becomes; left out: m00",
            .kind = Parameter::Kind::text,
            .choices = {"m00/m01/dolp"}};
}

MuellerElements muellerElements(const Parameters& parameters) {
    const std::string text = parameters.choice("mueller");
    return MuellerElements(text.empty() ? "m00" : text);
}

Fact muellerFact(const MuellerElements& elements) {
    if (elements.isReflectance())
        return {"element", "m00, the BRDF for unpolarised light; others by mueller=all or m01/m11"};
    return {"elements", fmt::format("{} of the Mueller matrix{}", fmt::join(elements.names(), " "),
                                    elements.arePositive() ? "" : ", 1/sr; may be below 0")};
}

void requireReflectance(const std::string& name, const Channels& channels, const char* taker) {
    if (channels.reflectances() == channels.count()) return;
    throw InputError(fmt::format("{}: {} is no reflectance; {} takes mueller=m00", name,
                                 channels.names()[channels.reflectances()], taker));
}

}  // namespace hshfit::brdfs
