#pragma once

#include <hshfit/material_library/basis.h>
#include <hshfit/material_library/learning.h>
#include <hshfit/representation/representation.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::material_library {

/// The way in which a library keeps a material:
///     coded       coordinates in the basis
///     polynomial  logTerms() of its own in single precision, which their cancellation needs: the
///                 basis does not hold it
///     halfway     a halfway form of its own: logTerms() do not hold it either
enum class Kind { coded, polynomial, halfway };
std::string_view nameOf(Kind kind);  ///< as in files

struct Material {
    std::string name, source;
    Kind kind = Kind::coded;
    std::size_t channels = 0;
    std::vector<std::uint8_t> codes = {};  ///< coded
    LogMaterial polynomial = {};           ///< polynomial
    std::string halfway = {};              ///< halfway: the JSON of a coefficient file
    std::size_t bytes = 0;                 ///< of its numbers
    std::string fallback = {};             ///< why it is not coded; empty: it is
    /// A material that was learned has the sum of the errors of the projection onto logTerms() and
    /// of the rounding to the basis, which is at least the distance from the source; of FLIP the
    /// root of the sum of their squares, as of errors that are independent.
    FormError error = {};
};

/// Materials and the basis that they share.
struct Library {
    LearnOptions asked = {};
    Limits limits = {};  ///< beyond which a material keeps a form of its own
    /// Root mean square error of ln(f + logOffset) of materials that took no part, as stored; 0:
    /// there were too few to tell.
    double unseen = 0;
    double unseenFlip = 0;  ///< the mean FLIP of these materials, where pictures were drawn
    Basis basis = {};
    /// The file of another library that has the basis, and its checksum. Empty: this library has
    /// its own basis.
    std::string basisFile = {}, basisSum = {};
    std::vector<Material> materials = {};  ///< by name
    /// The materials as learning again needs them, by name; empty: left out.
    std::vector<Measured> measured = {};
};

/// The greatest of each of the limits.
inline constexpr double greatestLimit = 10;

/// SHA-256 of the arrays of a basis as files keep them.
std::string checksum(const Basis& basis);

/// The material with a halfway form in half precision; `seen`: the error has FLIP. Throws as
/// projectHalfway does.
Material withHalfway(const Brdf& brdf, const std::string& name, const std::string& source,
                     bool seen = false);

/// Learns a basis from the materials of a store, which is sorted, and hands each material, as the
/// library stores it, to `take`, in the order of names: also the materials that have forms of their
/// own. The same materials give the same bytes in whatever order and parts they came. The answer is
/// the library without its materials. Memory holds some 100 bytes a material. Throws as learnBasis.
Library learn(const LogSpace& space, const MaterialStore& store, const LearnOptions& options,
              const Limits& limits, const std::function<void(Material)>& take,
              LearnedBasis* learned = nullptr);

/// The same for materials in memory, which are in the answer. Names have to be unique (UsageError).
Library learn(const LogSpace& space, std::vector<Measured> measured, std::vector<Material> own,
              const LearnOptions& options, const Limits& limits, LearnedBasis* learned = nullptr);

/// `measured` in the basis of a library: coded, or, beyond its limits, as a polynomial that says
/// so; the errors are against `source`, which was measured, or without one as Material::error says.
Material encode(const Library& library, const LogSpace& space, const Measured& measured,
                std::size_t components, const Brdf* source = nullptr);

/// The material as a BRDF of that name. Throws InputError for a halfway form that is invalid.
std::unique_ptr<Brdf> open(const Library& library, const Material& material,
                           const std::string& name);

/// ln(f + logOffset) of a material; none of one with a halfway form.
std::optional<LogMaterial> logMaterial(const Library& library, const Material& material);

/// The same, of a halfway form its projection: what distances are between. Throws as
/// LogSpace::project.
LogMaterial projectedMaterial(const LogSpace& space, const Library& library,
                              const Material& material);

/// The material of this name; nullptr if there is none.
const Material* find(const Library& library, std::string_view name);

/// Throws UsageError for a name that is empty, or has a character of specifications (':', ',',
/// '+', '*') or a control character.
void requireName(const std::string& name);

}  // namespace hshfit::material_library
