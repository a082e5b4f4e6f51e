#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/coefficients/coefficients.h>
#include <hshfit/wavelets/soho.h>

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace hshfit::wavelets {

/// The name of the basis in curves and tables.
inline constexpr std::string_view sohoName = "soho";

struct SliceOptions {
    Quantity quantity = Quantity::brdf;
    /// Levels are added until the energy of the best terms changes by less, relatively.
    double tolerance = 1e-3;
    int firstLevel = 6, lastLevel = 8;
};

/// The energy that the best k terms of f or f cos(theta_i) over wi capture, k = 0 .. most, chosen
/// for each outgoing direction and channel by itself and summed as in `Projection::captured`.
struct SliceCurve {
    std::vector<double> captured;
    double energy = 0;  ///< of all terms; that beyond the leaves is missing
    double error = 0;   ///< relative: a third of the last change, for errors that fall by 4 a level
    int levels = 0;
    std::size_t evaluations = 0;
};
/// Runs on all threads of oneTBB. Throws NumericError where f is no finite number.
SliceCurve sliceCurve(const Brdf& brdf, const OutgoingSet& outgoing, std::size_t most,
                      const SliceOptions& options = {});

/// The width of a stored coefficient.
enum class ValueBytes { half = 2, single = 4 };

/// A BRDF from the best k terms of each outgoing direction and channel, interpolated over outgoing
/// directions as Reconstruction does. A term is a value and an index of two bytes: the partition
/// has 7 levels, 65,536 functions.
class TermsBrdf : public Brdf {
public:
    /// Coefficients of every outgoing direction, from which any number of terms can be kept.
    struct Source {
        std::shared_ptr<const Partition> partition;
        OutgoingSet outgoing;
        Channels channels;
        Laws laws;
        std::string name;
        Quantity quantity;
        std::vector<std::vector<Term>> terms;  ///< [outgoing][channel], the best `most`
    };
    static std::shared_ptr<const Source> project(const Brdf& brdf, const OutgoingSet& outgoing,
                                                 Quantity quantity, std::size_t most);

    TermsBrdf(std::shared_ptr<const Source> source, std::size_t terms, ValueBytes width);

    std::string name() const override { return source_->name; }
    const Channels& channels() const override { return source_->channels; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override;

    /// Bytes of values and indices; terms that are 0 are stored all the same.
    std::size_t bytes() const;

private:
    std::shared_ptr<const Source> source_;
    Laws laws_;
    std::size_t count_;
    ValueBytes width_;
    std::vector<std::vector<Term>> terms_;
};

}  // namespace hshfit::wavelets
