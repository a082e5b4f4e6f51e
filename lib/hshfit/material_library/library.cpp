#include <hshfit/material_library/library.h>

#include <hshfit/coefficient_files/coefficient_formats.h>
#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>
#include <hshfit/files/checksum.h>
#include <hshfit/material_library/internal/rounding_errors.h>
#include <hshfit/material_library/log_terms.h>
#include <hshfit/pictures/picture_error.h>
#include <hshfit/representation/forms/represented_brdf.h>
#include <hshfit/representation/halfway/halfway.h>
#include <hshfit/representation/halfway/halfway_rounding.h>

#include <Imath/half.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace hshfit::material_library {
namespace {

constexpr std::array<std::string_view, 3> kindNames{"coded", "polynomial", "halfway"};

FormError sumOf(const FormError& a, const FormError& b) {
    return {a.meanLog + b.meanLog,
            a.logError + b.logError,
            a.relativeL2 + b.relativeL2,
            a.maximum + b.maximum,
            a.largest,
            a.flip + b.flip};
}

/// In the numbers that a file keeps.
LogMaterial rounded(LogMaterial material) {
    for (double& value : material.exponents) value = static_cast<float>(value);
    for (double& value : material.tops) value = static_cast<float>(value);
    return material;
}

FormError errorBetween(const Brdf& f, const Brdf& g, bool seen) {
    FormError error = formError(f, g, errorPairs());
    if (seen) error.flip = pictureError(f, g).flip.mean;
    return error;
}

FormError errorAgainst(const Measured& measured, const LogMaterial& stored, const Brdf* source,
                       bool seen) {
    const LogBrdf form(stored, measured.name);
    if (source) return errorBetween(*source, form, seen);
    return sumOf(measured.error,
                 errorBetween(LogBrdf(measured.material(), measured.name), form, seen));
}

/// A material with its codes, but for its error.
Material coded(const Encoder& encoder, const Measured& measured, std::size_t components) {
    Material material{
        .name = measured.name, .source = measured.source, .channels = measured.channels()};
    material.codes = encoder.encode(measured.material(), components);
    material.bytes = material.codes.size();
    return material;
}

/// Makes it a polynomial where its error is beyond the limits.
void fallBack(Material& material, const Limits& limits, const Measured& measured,
              const Brdf* source) {
    material.fallback = beyond(material.error, limits);
    if (material.fallback.empty()) return;
    material.fallback += " in the basis";
    material.kind = Kind::polynomial;
    material.codes.clear();
    material.polynomial = rounded(measured.material());
    material.bytes = material.polynomial.bytes();
    material.error = errorAgainst(measured, material.polynomial, source, limits.pictures());
}

/// Materials that go through RoundingErrors together.
constexpr std::size_t together = 16;

/// The measured materials of a library as it stores them.
std::vector<Material> storedMaterials(const Library& library, const LogSpace& space,
                                      const std::vector<Measured>& measured) {
    std::vector<Material> materials(measured.size());
    const Encoder encoder(library.basis, space);
    const RoundingErrors errors(library.basis);
    eachInParallel((measured.size() + together - 1) / together, [&](std::size_t part) {
        const std::size_t first = part * together,
                          last = std::min(first + together, measured.size());
        std::vector<RoundedMaterial> rounded;
        for (std::size_t m = first; m < last; ++m) {
            materials[m] = coded(encoder, measured[m], library.basis.size());
            rounded.push_back({measured[m], materials[m].codes});
        }
        const std::vector<FormError> found = errors.of(rounded);
        for (std::size_t m = first; m < last; ++m) {
            FormError error = found[m - first];
            if (library.limits.pictures())
                error.flip = pictureError(LogBrdf(measured[m].material(), measured[m].name),
                                          LogBrdf(decode(library.basis, materials[m].codes),
                                                  measured[m].name))
                                 .flip.mean;
            materials[m].error = sumOf(measured[m].error, error);
            fallBack(materials[m], library.limits, measured[m], nullptr);
        }
    });
    return materials;
}

template <class Row>
void requireUnique(const std::vector<Row>& sorted) {
    const auto twice = std::ranges::adjacent_find(sorted, {}, &Row::name);
    if (twice == sorted.end()) return;
    throw UsageError(
        fmt::format("two materials are named '{}' ({} and {}): give one of them "
                    "another name",
                    twice->name, twice->source, std::next(twice)->source));
}

}  // namespace

std::string_view nameOf(Kind kind) {
    return kindNames[static_cast<std::size_t>(kind)];
}

void requireName(const std::string& name) {
    const bool special = std::ranges::any_of(name, [](unsigned char c) {
        return c < ' ' || c == 127 ||
               std::string_view(":,+*").find(static_cast<char>(c)) != std::string_view::npos;
    });
    if (name.empty() || special || name.size() > 255)
        throw UsageError(
            fmt::format("'{}' cannot name a material: names have 1 to 255 characters, and no ':', "
                        "',', '+' or '*', which specifications use",
                        name));
}

std::string checksum(const Basis& basis) {
    std::string bytes;
    const auto add = [&](const auto& number) {
        bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
    };
    add(static_cast<float>(basis.step));
    for (const double value : basis.mean) add(static_cast<float>(value));
    for (const double value : basis.components) add(Imath::half(static_cast<float>(value)).bits());
    for (const std::uint8_t width : basis.widths) add(width);
    return sha256(bytes);
}

Material withHalfway(const Brdf& brdf, const std::string& name, const std::string& source,
                     bool seen) {
    Representation form = projectHalfway(brdf, {});
    quantiseHalfway(form, Precision::half, brdf);
    Material material{.name = name,
                      .source = source,
                      .kind = Kind::halfway,
                      .channels = brdf.channels().count(),
                      .halfway = representationToJson(form),
                      .bytes = form.bytes()};
    material.error = errorBetween(brdf, *reconstruct(std::move(form), {}), seen);
    return material;
}

Material encode(const Library& library, const LogSpace& space, const Measured& measured,
                std::size_t components, const Brdf* source) {
    Material material = coded(Encoder(library.basis, space), measured, components);
    material.error = errorAgainst(measured, decode(library.basis, material.codes), source,
                                  library.limits.pictures());
    fallBack(material, library.limits, measured, source);
    return material;
}

Library learn(const LogSpace& space, std::vector<Measured> measured, std::vector<Material> own,
              const LearnOptions& options, const Limits& limits, LearnedBasis* learned) {
    std::ranges::sort(measured, {}, &Measured::name);
    Library library{.asked = options, .limits = limits};
    LearnedBasis basis = learnBasis(space, measured, options, limits.pictures());
    library.basis = basis.basis;
    library.unseen = basis.unseen;
    library.unseenFlip = basis.unseenFlip;
    library.materials = storedMaterials(library, space, measured);
    std::ranges::move(own, std::back_inserter(library.materials));
    std::ranges::sort(library.materials, {}, &Material::name);
    requireUnique(library.materials);
    library.measured = std::move(measured);
    if (learned) *learned = std::move(basis);
    return library;
}

std::optional<LogMaterial> logMaterial(const Library& library, const Material& material) {
    switch (material.kind) {
        case Kind::coded:
            return decode(library.basis, material.codes);
        case Kind::polynomial:
            return material.polynomial;
        case Kind::halfway:
            break;
    }
    return std::nullopt;
}

std::unique_ptr<Brdf> open(const Library& library, const Material& material,
                           const std::string& name) {
    if (std::optional<LogMaterial> logs = logMaterial(library, material))
        return std::make_unique<LogBrdf>(std::move(*logs), name);
    Representation form = representationFromJson(material.halfway, name);
    form.head.source = name;
    return reconstruct(std::move(form), {});
}

const Material* find(const Library& library, std::string_view name) {
    const auto found = std::ranges::lower_bound(library.materials, name, {}, &Material::name);
    return found != library.materials.end() && found->name == name ? &*found : nullptr;
}

}  // namespace hshfit::material_library
