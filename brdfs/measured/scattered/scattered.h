#pragma once

#include <brdfs/measured/measured_brdf.h>
#include <brdfs/measured/own_samples.h>
#include <brdfs/measured/scattered/interpolant.h>
#include <brdfs/measured/scattered/sample_lobes.h>
#include <brdfs/measured/scattered/samples.h>
#include <brdfs/rows/spec.h>
#include <hshfit/projection/least_squares.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::brdfs {

class TableInterpolant;

/// The assumed symmetries of scattered samples. None: those stated in the file or else implied
/// by its directions. Samples are isotropic if all incident or all outgoing directions have one
/// azimuth, and mirrored if they are isotropic and all on one side of the plane of incidence.
struct ScatteredOptions {
    std::optional<bool> isotropic = {};
    std::optional<bool> mirror = {};
    bool exchange = true;  ///< a sample stands for the exchanged pair, unless that was measured
    double reach = radians(10);  ///< distance from a sample within which f rests on it
    double scale = 1;            ///< f over the values of the file
    /// The pole of the angles that the tables of a format are over, if it has tables
    /// (angle_tables.h).
    enum class Tables { none, aboutNormal, aboutMirror };
    Tables tables = Tables::none;
};

/// The options `isotropic`, `mirror`, `exchange`, `reach`, `scale` and `quantity` of every
/// scattered format, followed by `more`. With quantity=radiance-factor the values are pi f, 1 for
/// an ideal Lambert surface.
std::vector<Parameter> scatteredParameters(std::vector<Parameter> more = {});
ScatteredOptions scatteredOptions(const Parameters& parameters);
/// f over the values of the file: by `scale` and `quantity`.
double scaleOf(const Parameters& parameters);

/// The option `zeros` of formats that have no mark for directions without a measurement but 0.
Parameter zerosParameter();
bool zerosAreMeasured(const Parameters& parameters);
/// The remark on `count` values of 0 that were left out.
std::string zerosLeftOut(std::size_t count);

/// As openScattered (text_file.h) for a format of tables about the normal.
std::unique_ptr<Brdf> openTables(
    const std::string& path, const Parameters& parameters,
    const std::function<Samples(std::string_view, const std::string&)>& read);

/// A BRDF interpolated between scattered samples: `ScatterInterpolant` in the coordinates of
/// `Chart`. Within `reach` of the nearest sample (or of its image under the symmetries) f is
/// interpolated and coverage() is 1; from there to 1.5 reach it fades to 0; beyond it is 0.
/// Values below zero count as 0. Never negative, continuous above the horizon; mirror symmetric
/// exactly where folded so, isotropic to rounding.
///
/// With `exchange`, f is reciprocal exactly, unless samples contradict it: where both orders of a
/// pair were measured and differ by more than 1e-3, f has the measured value in each order, and
/// Laws::reciprocal is false.
///
/// Where the samples come in tables that TableInterpolant suits, f is interpolated on these
/// instead, and the former holds past them, where f fades from the one to the other. f is then not
/// taken as reciprocal.
class Scattered : public MeasuredBrdf, public HasMeasuredPairs {
public:
    /// Throws InputError, starting with `name`, if there are no samples above the horizon.
    Scattered(Samples samples, const ScatteredOptions& options, std::string name);
    ~Scattered() override;

    std::string name() const override { return name_; }
    const Channels& channels() const override { return samples_.channels; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override;
    void coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const override;
    /// 3e-3: measurements err by more.
    double defaultTolerance() const override { return 3e-3; }
    std::vector<Fact> facts() const override;
    Census census() const override { return samples_.census; }
    std::vector<Axis> axes() const override;
    std::optional<BothOrders> bothOrders() const override;
    /// A lobe about the mirror configuration, and one about the way back, where samples of pairs
    /// show them (sample_lobes.h).
    std::vector<Lobe> lobes(const Direction& wo) const override;

    const Samples& samples() const override { return samples_; }
    std::unique_ptr<Brdf> scaled(double factor, std::string name) const override;

private:
    void interpolateOnTables();
    /// f by the scattered samples, fading beyond the reach.
    void evalScattered(const Point& at, double* out, std::size_t stride,
                       ScatterInterpolant::Trail& trail) const;

    Samples samples_;
    ScatteredOptions options_;
    std::string name_;
    Chart chart_;
    Folding folding_;
    Laws laws_;
    std::vector<Point> images_;  ///< that f is the same at
    SampleLobes lobes_;
    std::unique_ptr<ScatterInterpolant> interpolant_;
    std::unique_ptr<TableInterpolant> onTables_;  ///< null for samples in no tables
};

/// The measured pairs behind a BRDF, without what it interpolates between them.
struct MeasuredPairs {
    Samples samples;  ///< in the channels of the BRDF
    Laws laws;        ///< of the BRDF
    std::string name;
    /// A view of the samples, values below zero included. Throws UsageError for data that were
    /// reduced to fewer coordinates than a pair of directions has.
    DirectionSamples directionSamples() const;
};
/// The pairs of a BRDF that HasMeasuredPairs, also as seen through a ChannelView; none for any
/// other BRDF.
std::optional<MeasuredPairs> measuredPairs(const Brdf& brdf);

}  // namespace hshfit::brdfs
