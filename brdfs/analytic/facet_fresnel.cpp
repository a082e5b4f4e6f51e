#include <brdfs/analytic/facet_fresnel.h>

#include <brdfs/analytic/parameters.h>
#include <brdfs/rows/spec.h>
#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>

namespace hshfit::brdfs {
namespace {

/// The keys that a form takes; the first table entry is the default.
struct Form {
    std::string_view name;
    bool f0, ior, k;
};
constexpr Form forms[] = {{"schlick", true, false, false},
                          {"dielectric", false, true, false},
                          {"conductor", false, true, true}};

const Form& formOf(const Parameters& p) {
    const std::string name = p.choice("fresnel");
    return *std::ranges::find(forms, std::string_view(name), &Form::name);
}

void checkKeys(const Model& model, const Parameters& p) {
    const Form& form = formOf(p);
    const auto refuse = [&](std::string_view key) {
        throw UsageError(
            fmt::format("{}: fresnel={} takes no {}; valid: F0 with schlick, ior with "
                        "dielectric, ior and k with conductor",
                        model.name, form.name, key));
    };
    const auto demand = [&](std::string_view key) {
        const auto& declared = model.parameters;
        const auto found = std::ranges::find(declared, key, &Parameter::name);
        throw UsageError(fmt::format("{}: fresnel={} needs {}; valid: {}", model.name, form.name,
                                     key, validValues(*found)));
    };
    if (p.given("F0") && !form.f0) refuse("F0");
    if (p.given("ior") && !form.ior) refuse("ior");
    if (p.given("k") && !form.k) refuse("k");
    if (!p.given("ior") && form.ior) demand("ior");
    if (!p.given("k") && form.k) demand("k");
}

}  // namespace

std::vector<Parameter> facetFresnelParameters() {
    constexpr double notGiven = -1;
    return {fitted(f0Parameter(), {{.low = 0.02, .high = 0.9, .choice = "fresnel=schlick"}}),
            {.name = "fresnel",
             .help = "Schlick's form of F0, or exact for ior, or for ior and k",
             .kind = Parameter::Kind::choice,
             .choices = {forms[0].name, forms[1].name, forms[2].name}},
            {.name = "ior",
             .help = "index of refraction, for dielectric and conductor",
             .kind = Parameter::Kind::colour,
             .fallback = notGiven,
             .min = 0.01,
             .max = 100,
             .fit = {{.low = 1.05, .high = 4, .logarithmic = true, .choice = "fresnel=dielectric"},
                     {.low = 0.2, .high = 4, .logarithmic = true, .choice = "fresnel=conductor"}}},
            {.name = "k",
             .help = "extinction coefficient, for conductor",
             .kind = Parameter::Kind::colour,
             .fallback = notGiven,
             .min = 0,
             .max = 100,
             .fit = {{.low = 0.5, .high = 6, .choice = "fresnel=conductor"}}}};
}

FacetFresnel::FacetFresnel(const Model& model, const Parameters& p) {
    checkKeys(model, p);
    const Form& form = formOf(p);
    if (form.f0) {
        weights_ = {p.colour("F0"), {1.0}};
        return;
    }
    const Colour ior = p.colour("ior"), k = form.k ? p.colour("k") : Colour{0.0};
    const std::size_t count = std::max(ior.size(), k.size());
    for (std::size_t c = 0; c < count; ++c) {
        indices_.push_back({ior[ior.size() == 1 ? 0 : c], k[k.size() == 1 ? 0 : c]});
        weights_.push_back(Colour(count, 0.0));
        weights_.back()[c] = 1;
    }
}

std::vector<Colour> FacetFresnel::weights(const Colour& scale) const {
    std::vector<Colour> scaled;
    for (const Colour& weight : weights_)
        scaled.push_back(mapped(weight, scale, [](double w, double s) { return w * s; }));
    return scaled;
}

}  // namespace hshfit::brdfs
