#include <brdfs/measured/mueller.h>
#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>

namespace hshfit::brdfs {
namespace {

constexpr const char* factName = "element";

/// Row after row, then the degree of polarisation.
constexpr std::string_view names[] = {"m00", "m01", "m02", "m03", "m10", "m11", "m12", "m13", "m20",
                                      "m21", "m22", "m23", "m30", "m31", "m32", "m33", "dolp"};

}  // namespace

MuellerElement::MuellerElement(std::string name) : name_(std::move(name)) {
    if (isDegree()) {
        places_ = {0, 4, 8};
        return;
    }
    places_ = {static_cast<std::size_t>(std::ranges::find(names, name_) - std::begin(names))};
}

double MuellerElement::value(const double* values) const {
    if (isReflectance()) return std::max(values[0], 0.0);
    if (!isDegree()) return values[0];
    return values[0] > 0 ? std::hypot(values[1], values[2]) / values[0] : 0;
}

Parameter muellerParameter() {
    return {.name = "mueller",
            .help =
                "element of the Mueller matrices, row and column counted from 0; dolp: the "
                "degree of linear polarisation of what unpolarised light becomes",
            .kind = Parameter::Kind::choice,
            .choices = {std::begin(names), std::end(names)}};
}

MuellerElement muellerElement(const Parameters& parameters) {
    return MuellerElement(parameters.choice("mueller"));
}

Fact muellerFact(const MuellerElement& element) {
    if (element.isReflectance())
        return {factName, "m00, the BRDF for unpolarised light; the others by mueller=m01 ... m33"};
    if (element.isDegree()) return {factName, "dolp, a degree of linear polarisation, no unit"};
    return {factName,
            fmt::format("{} of the Mueller matrix, 1/sr; may be below 0", element.name())};
}

void requireReflectance(const Brdf& brdf, const char* command) {
    for (const auto& [name, value] : brdf.facts()) {
        if (name != factName) continue;
        const auto& text = std::get<std::string>(value);
        if (text.starts_with("m00")) return;
        throw InputError(fmt::format("{}: {} is no reflectance; {} takes mueller=m00", brdf.name(),
                                     text.substr(0, text.find_first_of(" ,")), command));
    }
}

}  // namespace hshfit::brdfs
