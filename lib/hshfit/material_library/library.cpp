#include <hshfit/material_library/library.h>

#include <hshfit/coefficient_files/coefficient_formats.h>
#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>
#include <hshfit/files/checksum.h>
#include <hshfit/material_library/internal/rounding_errors.h>
#include <hshfit/material_library/log_terms.h>
#include <hshfit/material_library/material_store.h>
#include <hshfit/pictures/picture_error.h>
#include <hshfit/representation/forms/represented_brdf.h>
#include <hshfit/representation/halfway/halfway.h>
#include <hshfit/representation/halfway/halfway_rounding.h>

#include <Imath/half.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::material_library {
namespace {

constexpr std::array<std::string_view, 3> kindNames{"coded", "polynomial", "halfway"};

FormError sumOf(const FormError& a, const FormError& b) {
    return {a.meanLog + b.meanLog,
            a.logError + b.logError,
            a.relativeL2 + b.relativeL2,
            a.maximum + b.maximum,
            a.largest,
            std::hypot(a.flip, b.flip)};
}

/// The material rounded to single precision, as files keep it.
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

/// Materials that go through RoundingErrors together, and those that are in memory.
constexpr std::size_t together = 16, atOnce = 64 * together;

/// Stores measured materials in a basis.
class MaterialCoder {
public:
    MaterialCoder(const Library& library, const LogSpace& space, const MaterialStore& store)
        : library_(library),
          store_(store),
          encoder_(library.basis, space),
          errors_(library.basis) {}

    /// The materials `first` to `last` of the store; `first` is a multiple of `together`.
    std::vector<Material> coded(std::size_t first, std::size_t last) const {
        std::vector<Material> materials(last - first);
        eachInParallel((last - first + together - 1) / together, [&](std::size_t part) {
            const std::size_t from = first + part * together;
            addCoded(from, std::min(from + together, last), materials.data() + part * together);
        });
        return materials;
    }

private:
    void addCoded(std::size_t first, std::size_t last, Material* materials) const {
        std::vector<Measured> measured;
        for (std::size_t m = first; m < last; ++m) measured.push_back(store_.measured(m));
        std::vector<RoundedMaterial> rounded;
        for (std::size_t k = 0; k < measured.size(); ++k) {
            materials[k] = material_library::coded(encoder_, measured[k], library_.basis.size());
            rounded.push_back({measured[k], materials[k].codes});
        }
        const std::vector<FormError> found = errors_.of(rounded);
        for (std::size_t k = 0; k < measured.size(); ++k) {
            FormError error = found[k];
            if (library_.limits.pictures())
                error.flip = pictureError(LogBrdf(measured[k].material(), measured[k].name),
                                          LogBrdf(decode(library_.basis, materials[k].codes),
                                                  measured[k].name))
                                 .flip.mean;
            materials[k].error = sumOf(measured[k].error, error);
            fallBack(materials[k], library_.limits, measured[k], nullptr);
        }
    }

    const Library& library_;
    const MaterialStore& store_;
    Encoder encoder_;
    RoundingErrors errors_;
};

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
    if (basis.scaled) add(std::uint8_t{scaleBits});
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

Library learn(const LogSpace& space, const MaterialStore& store, const LearnOptions& options,
              const Limits& limits, const std::function<void(Material)>& take,
              LearnedBasis* learned) {
    Library library{.asked = options, .limits = limits};
    LearnedBasis basis = learnBasis(space, store, options, limits.pictures());
    library.basis = basis.basis;
    library.unseen = basis.unseen;
    library.unseenFlip = basis.unseenFlip;
    const MaterialCoder coder(library, space, store);
    std::size_t own = 0;
    for (std::size_t first = 0; first < store.size(); first += atOnce) {
        const std::size_t last = std::min(first + atOnce, store.size());
        for (Material& material : coder.coded(first, last)) {
            for (; own < store.ownForms() && store.ownName(own) < material.name; ++own)
                take(store.own(own));
            take(std::move(material));
        }
    }
    for (; own < store.ownForms(); ++own) take(store.own(own));
    if (learned) *learned = std::move(basis);
    return library;
}

Library learn(const LogSpace& space, std::vector<Measured> measured, std::vector<Material> own,
              const LearnOptions& options, const Limits& limits, LearnedBasis* learned) {
    MaterialStore store(scratchFolder({}));
    for (const Measured& one : measured) store.add(one);
    for (const Material& one : own) store.add(one);
    store.sort();
    std::vector<Material> materials;
    Library library = learn(
        space, store, options, limits,
        [&](Material material) { materials.push_back(std::move(material)); }, learned);
    library.materials = std::move(materials);
    std::ranges::sort(measured, {}, &Measured::name);
    library.measured = std::move(measured);
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

LogMaterial projectedMaterial(const LogSpace& space, const Library& library,
                              const Material& material) {
    if (std::optional<LogMaterial> logs = logMaterial(library, material)) return std::move(*logs);
    const auto brdf = open(library, material, material.name);
    return space.project(*brdf, material.name, material.source).material();
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
