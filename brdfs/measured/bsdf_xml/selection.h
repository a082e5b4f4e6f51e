#pragma once

#include <brdfs/measured/bsdf_xml/document.h>
#include <hshfit/brdf/brdf.h>

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// The kinds of blocks as the file names them, `front` and `back` for reflections. The side is the
/// one that the light comes from. Radiance exchanges the words: its front, towards +z and the room,
/// is the file's back.
enum class BsdfSide { front, back, transmissionFront, transmissionBack };

/// "Reflection Front", …, as in files.
std::string_view blockName(BsdfSide side);
/// "front", "back", "transmission-front" or "transmission-back": the value of the option `side`.
std::string_view sideWord(BsdfSide side);
/// The kind that an option states, "reflection-front" and "front" alike; none for other words.
std::optional<BsdfSide> sideNamed(std::string_view word);
inline bool isTransmission(BsdfSide side) {
    return side == BsdfSide::transmissionFront || side == BsdfSide::transmissionBack;
}
inline bool isFront(BsdfSide side) {
    return side == BsdfSide::front || side == BsdfSide::transmissionFront;
}
/// The reflection of light from the same side for a transmission, and the reverse.
BsdfSide counterpart(BsdfSide side);

/// The blocks of a document that one BRDF is made of, and the facts that all kinds of blocks share.
///
/// Directions. Files have one frame for both sides: x and y along the surface, z out of the back.
/// Local frames are right-handed with +z out of the surface towards the incident light: (x, y, z)
/// on the back, and turned about y, (-x, y, -z), on the front. Outgoing directions of transmissions
/// are mirrored at the surface (hshfit/brdf/transmission.h), so that they have the same (x, y).
struct BsdfSelection {
    std::string name;  ///< a specification that opens the same BRDF
    BsdfSide side = BsdfSide::front;
    std::string wavelength;  ///< as the file spells it
    const BsdfBlock* main = nullptr;
    /// CIE-X and CIE-Z for a matrix, CIE-u and CIE-v for a tree; null: grey.
    std::array<const BsdfBlock*, 2> colour{};
    /// Blocks for one wavelength each, ascending, `main` the first; empty: a part of the spectrum.
    std::vector<const BsdfBlock*> spectrum;
    double tolerance = 1e-2;  ///< of quadrature: f is a step function
    std::vector<Fact> facts;  ///< format, side, unused blocks, …
    std::string corrupt;      ///< message of checkIntact(); empty: none

    /// Drops the pointers into the document once the blocks are read.
    void forgetBlocks() {
        main = nullptr;
        colour = {};
        spectrum.clear();
    }
    bool coloured() const { return colour[0] != nullptr; }
    /// x in the file's frame.
    double fileX(double x) const { return isFront(side) ? -x : x; }
    void checkIntact() const {
        if (!corrupt.empty()) throw InputError(corrupt);
    }
};

/// Finds the blocks of one kind. Without a side it is the front's reflection, or the back's where
/// the file has no other; of a file without reflections, a transmission in the same way.
/// `wavelength`: a word of the file ("visible": with colours if the file has them), a wavelength in
/// nm, "spectrum" for all blocks of single wavelengths, or empty: visible if the file has it, else
/// the spectrum. Throws InputError for missing blocks, naming those in the file, and for
/// duplicates.
BsdfSelection selectBlocks(const BsdfDocument& document, std::optional<BsdfSide> side,
                           std::string_view wavelength);

/// Whether the file has blocks of one kind for a wavelength, as above. Throws likewise for
/// duplicates.
bool hasBlocks(const BsdfDocument& document, BsdfSide side, std::string_view wavelength);

/// Linear RGB of CIE XYZ with the primaries of Rec. 709 and the white of equal energy, which these
/// files use for a neutral surface: X = Y = Z gives R = G = B. Negative components, outside of the
/// gamut, are kept.
std::array<double, 3> rgbOfXyz(double x, double y, double z);
/// Linear RGB, as above, of luminance and CIE 1976 (u', v'), taken as at most 1; neutral for v'
/// below 1e-3.
std::array<double, 3> rgbOfYuv(double y, double u, double v);

/// A file whose numbers have six or seven digits may exceed a reflectance of 1 by this much.
inline constexpr double roundingOfFiles = 1e-6;

/// The value that `eval` uses: 0 in place of a negative one or NaN.
inline double asReflectance(double value) {
    return value > 0 ? value : 0;
}

}  // namespace hshfit::brdfs
