#include <hshfit/normal_filtering/mip_errors.h>

#include <hshfit/bases/sh.h>
#include <hshfit/brdf/uniform.h>
#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>
#include <hshfit/normal_filtering/internal/mip_footprint.h>
#include <hshfit/normal_filtering/surface_frame.h>

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace hshfit::inline normal_filtering {
namespace {

/// A base texel ready for evaluation.
struct Facet {
    SurfaceTexel texel;
    SurfaceFrame frame;
    explicit Facet(const SurfaceTexel& t) : texel(t), frame(t.normal, t.tangent) {}
};

std::vector<SurfaceTexel> sampled(const FilteredSurface& s, const Footprint& f, int samples,
                                  std::mt19937_64& random) {
    std::vector<SurfaceTexel> facets;
    if (f.width * f.height <= static_cast<std::size_t>(samples)) {
        for (std::size_t k = 0; k < f.width * f.height; ++k)
            facets.push_back(s.texel(f.x + k % f.width, f.y + k / f.width));
        return facets;
    }
    const int side = static_cast<int>(std::sqrt(samples));
    for (int k = 0; k < side * side; ++k) {
        const double x = (k % side + uniform(random)) / side * static_cast<double>(f.width);
        const double y = (k / side + uniform(random)) / side * static_cast<double>(f.height);
        facets.push_back(
            s.texel(f.x + static_cast<std::size_t>(x), f.y + static_cast<std::size_t>(y)));
    }
    return facets;
}

/// The texel of ordinary mips: every parameter averaged by itself.
SurfaceTexel meanTexel(const FilteredSurface& s, const Footprint& f) {
    SurfaceTexel mean = noTexel();
    const double share = 1 / static_cast<double>(f.width * f.height);
    for (std::size_t k = 0; k < f.width * f.height; ++k)
        addToMean(s.texel(f.x + k % f.width, f.y + k / f.width), share, mean);
    if (!(dot(mean.normal, mean.normal) > 1e-12)) mean.normal = {0, 0, 1};
    return mean;
}

void addReflected(const FilteredSurface& s, const Facet& facet, const Direction& wi,
                  const Direction& wo, std::span<double> out) {
    std::fill(out.begin(), out.end(), 0.0);
    const Direction i = facet.frame.toLocal(wi), o = facet.frame.toLocal(wo);
    if (!(i.z > 0) || !(o.z > 0)) return;
    s.brdf(facet.texel, i, o, out);
    for (double& value : out) value *= i.z;
}

/// A Gaussian in the stereographic plane for half vectors.
class HalfSampler {
public:
    HalfSampler(const PlanePoint& mean, double xx, double xy, double yy) : mean_(mean) {
        a_ = std::sqrt(std::max(xx, 1e-12));
        b_ = xy / a_;
        c_ = std::sqrt(std::max(yy - b_ * b_, 1e-12));
    }
    Direction draw(std::mt19937_64& random) const {
        const double radius = std::sqrt(-2 * std::log(1 - uniform(random)));
        const double phi = 2 * pi * uniform(random);
        const double x = radius * std::cos(phi), y = radius * std::sin(phi);
        return fromPlane({mean_[0] + a_ * x, mean_[1] + b_ * x + c_ * y});
    }
    double density(const Direction& h) const {
        const PlanePoint u = toPlane(h);
        const double x = (u[0] - mean_[0]) / a_, y = (u[1] - mean_[1] - b_ * x) / c_;
        const double scale = 1 + (u[0] * u[0] + u[1] * u[1]) / 4;
        return std::exp(-(x * x + y * y) / 2) / (2 * pi * a_ * c_) * scale * scale;
    }

private:
    PlanePoint mean_;
    double a_, b_, c_;
};

/// Weights of integrals over the hemispheres; 0 for wi below the horizon.
struct Pair {
    Direction wi, wo;
    double outgoingWeight, incomingWeight = 0, weight = 0;
};

/// Incoming directions for one wo: half over the hemisphere by cosine, a quarter each about the
/// mirror direction with the widths of filtered and base lobes; weights by the sum of densities.
void appendPairs(const Direction& wo, double weight, const HalfSampler& wide,
                 const HalfSampler& narrow, int count, std::mt19937_64& random,
                 std::vector<Pair>& pairs) {
    const int cells = std::max(1, static_cast<int>(std::sqrt(count / 2)));
    for (int k = 0; k < count; ++k) {
        Direction wi;
        if (k % 2 == 0) {
            const int cell = k / 2;
            const double square = (cell % cells + uniform(random)) / cells;
            const double phi = 2 * pi * ((cell / cells) % cells + uniform(random)) / cells;
            wi = {std::sqrt(square) * std::cos(phi), std::sqrt(square) * std::sin(phi),
                  std::sqrt(1 - square)};
        } else {
            const Direction h = (k % 4 == 1 ? wide : narrow).draw(random);
            wi = 2 * dot(h, wo) * h - wo;
        }
        Pair pair{wi, wo, weight};
        if (wi.z > 1e-6) {
            const Direction h = normalised(wi + wo);
            const double jacobian = 1 / (4 * dot(h, wo));
            const double density = 0.5 * wi.z / pi + 0.25 * jacobian * wide.density(h) +
                                   0.25 * jacobian * narrow.density(h);
            pair.incomingWeight = 1 / (count * density);
            pair.weight = weight * pair.incomingWeight;
        }
        pairs.push_back(pair);
    }
}

std::vector<Pair> pairsFor(std::span<const double> numbers, const MipErrorOptions& options,
                           std::mt19937_64& random) {
    const double* u = &numbers[MipLayout::plane];
    const double* squares = &numbers[MipLayout::planeSquares];
    const double* width = &numbers[MipLayout::widths];
    const PlanePoint mean{u[0], u[1]};
    const HalfSampler narrow(mean, width[0], width[1], width[2]);
    const HalfSampler wide(mean, squares[0] - u[0] * u[0] + width[0],
                           squares[1] - u[0] * u[1] + width[1],
                           squares[2] - u[1] * u[1] + width[2]);
    std::vector<Pair> pairs;
    const double step = radians(88) / options.outgoing;
    double turn = uniform(random);
    for (int k = 0; k < options.outgoing; ++k) {
        const double theta = (k + uniform(random)) * step;
        turn += 0.6180339887498949;  // the golden ratio spreads azimuths over all elevations
        appendPairs(directionFromAngles(theta, 2 * pi * turn), 2 * pi * step * std::sin(theta),
                    wide, narrow, options.incoming, random, pairs);
    }
    return pairs;
}

/// Numbers that pairsFor draws, whatever the texel: an angle; for each outgoing direction another,
/// and two for each incoming one.
unsigned long long drawsOfPairs(const MipErrorOptions& options) {
    return 1 + static_cast<unsigned long long>(options.outgoing) *
                   (1 + 2 * static_cast<unsigned long long>(options.incoming));
}

/// f cos(theta_i) of the truth and of all forms for the pairs of a mip texel.
struct Values {
    std::vector<double> truth, variance;     // [pair][channel]
    std::vector<std::vector<double>> forms;  // [form][pair][channel]
};

/// All forms of a level, without errors yet.
std::vector<MipError> formsOf(const MipLayout& layout, const MipErrorOptions& options) {
    const std::size_t ellipse = layout.ellipseSize();
    // Ordinary mips have a normal, a tangent's angle, the lobe's place, weights and albedos.
    std::vector<MipError> forms{
        {.form = "parameters",
         .numbers = static_cast<std::size_t>(5 + layout.weights + layout.albedos)},
        {.form = "ellipse", .use = {MipForm::ellipse}, .numbers = ellipse}};
    std::vector<int> orders = options.orders;
    if (options.harmonics && orders.empty()) orders = {layout.order};
    for (const int order : orders) {
        if (order < 1 || order % 2 == 0 || order > layout.order)
            throw UsageError(
                fmt::format("order {} of a filtered texel: an odd number from 1 to "
                            "{} is needed",
                            order, layout.order));
        forms.push_back(
            {.form = "harmonics",
             .use = {MipForm::harmonics, order},
             .numbers = ellipse + static_cast<std::size_t>(layout.weights) * evenSlots(order)});
    }
    const std::size_t count = forms.size();
    for (std::size_t f = 1; options.atMeanNormal && f < count; ++f) {
        MipError form = forms[f];
        form.form += " at normal";
        form.use.facets = false;
        forms.push_back(form);
    }
    return forms;
}

void trueValues(const FilteredSurface& s, const std::vector<Facet>& facets, const Pair& pair,
                bool all, bool byVisibleArea, double* truth, double* variance) {
    const auto channels = static_cast<std::size_t>(s.channels);
    std::vector<double> value(channels);
    const double n = static_cast<double>(facets.size());
    double areas = 0;
    for (const Facet& facet : facets) {
        const Direction& normal = facet.frame.z;
        const double area =
            byVisibleArea ? std::max(0.0, dot(normal, pair.wo)) / std::max(normal.z, 1e-3) : 1;
        areas += area;
        addReflected(s, facet, pair.wi, pair.wo, value);
        for (std::size_t c = 0; c < channels; ++c) {
            truth[c] += area * value[c];
            variance[c] += area * value[c] * value[c];
        }
    }
    if (!(areas > 0)) return;
    for (std::size_t c = 0; c < channels; ++c) {
        truth[c] /= areas;
        variance[c] = all ? 0 : std::max(0.0, variance[c] / areas - truth[c] * truth[c]) / (n - 1);
    }
}

Values valuesOf(const FilteredSurface& s, const std::vector<Facet>& facets, const Facet& mean,
                const FilteredTexel& filtered, const std::vector<MipError>& forms,
                const std::vector<Pair>& pairs, bool all, bool byVisibleArea) {
    const auto channels = static_cast<std::size_t>(s.channels);
    Values v;
    v.truth.assign(pairs.size() * channels, 0.0);
    v.variance = v.truth;
    v.forms.assign(forms.size(), v.truth);
    eachInParallel(pairs.size(), [&](std::size_t k) {
        const Pair& pair = pairs[k];
        if (!(pair.weight > 0)) return;
        trueValues(s, facets, pair, all, byVisibleArea, &v.truth[k * channels],
                   &v.variance[k * channels]);
        for (std::size_t f = 0; f < forms.size(); ++f) {
            const std::span<double> out(&v.forms[f][k * channels], channels);
            if (forms[f].form == "parameters")
                addReflected(s, mean, pair.wi, pair.wo, out);
            else
                filtered.reflect(forms[f].use, s.rest, pair.wi, pair.wo, out, s.shape);
        }
    });
    return v;
}

/// Sums of one mip texel: of the truth, and of each form.
struct TruthSums {
    double norm = 0, noise = 0, albedo = 0;
};
struct FormSums {
    double distance = 0, albedo = 0, worstAlbedo = 0;
    double maximum = 0;  ///< difference over the largest true value, and its place
    Direction wi = {}, wo = {};
};

/// The record of a mip texel, in numbers that processes exchange: sums of the truth, then of forms.
template <class Sums>
using Doubles = std::array<double, sizeof(Sums) / sizeof(double)>;

std::size_t recordSize(std::size_t forms) {
    return (sizeof(TruthSums) + forms * sizeof(FormSums)) / sizeof(double);
}
template <class Sums>
Sums readSums(const double* from) {
    Doubles<Sums> numbers;
    std::copy_n(from, numbers.size(), numbers.begin());
    return std::bit_cast<Sums>(numbers);
}
template <class Sums>
void writeSums(const Sums& sums, double* to) {
    std::ranges::copy(std::bit_cast<Doubles<Sums>>(sums), to);
}

/// Incoming directions of each outgoing one, and channels of each pair.
struct PairSizes {
    std::size_t incoming, channels;
};

FormSums sumsOf(const std::vector<Pair>& pairs, const Values& v, const std::vector<double>& form,
                const PairSizes& sizes, const TruthSums& truth, double cosines) {
    double largest = 0;
    FormSums sums;
    std::vector<double> own(pairs.size() / sizes.incoming, 0.0), directional = own;
    for (std::size_t k = 0; k < v.truth.size(); ++k)
        largest = std::max(largest, v.truth[k] * pairs[k / sizes.channels].wo.z);
    for (std::size_t k = 0; k < v.truth.size(); ++k) {
        const Pair& p = pairs[k / sizes.channels];
        const double difference = (form[k] - v.truth[k]) * p.wo.z;
        sums.distance += p.weight * difference * difference;
        sums.albedo += p.weight * p.wo.z * form[k];
        directional[k / sizes.channels / sizes.incoming] += p.incomingWeight * v.truth[k];
        own[k / sizes.channels / sizes.incoming] += p.incomingWeight * form[k];
        if (p.weight > 0 && std::abs(difference) > sums.maximum * largest) {
            sums.maximum = std::abs(difference) / largest;
            sums.wi = p.wi;
            sums.wo = p.wo;
        }
    }
    for (std::size_t o = 0; o < own.size(); ++o)
        sums.worstAlbedo = std::max(sums.worstAlbedo,
                                    std::abs(own[o] - directional[o]) / (truth.albedo / cosines));
    return sums;
}

void fillRecord(const std::vector<Pair>& pairs, const Values& v, const PairSizes& sizes,
                double* record) {
    TruthSums truth;
    double cosines = 0;
    for (std::size_t k = 0; k < v.truth.size(); ++k) {
        const Pair& p = pairs[k / sizes.channels];
        const double scale = p.weight * p.wo.z * p.wo.z;
        truth.norm += scale * v.truth[k] * v.truth[k];
        truth.noise += scale * v.variance[k];
        truth.albedo += p.outgoingWeight * p.incomingWeight * p.wo.z * v.truth[k];
    }
    for (std::size_t k = 0; k < pairs.size(); k += sizes.incoming)
        cosines += pairs[k].outgoingWeight * pairs[k].wo.z;
    writeSums(truth, record);
    for (std::size_t f = 0; f < v.forms.size(); ++f)
        writeSums(sumsOf(pairs, v, v.forms[f], sizes, truth, cosines), record + recordSize(f));
}

/// Adds up the records of all mip texels.
void addRecords(const std::vector<double>& records, MipErrors& result) {
    const std::size_t size = recordSize(result.forms.size());
    TruthSums all;
    for (std::size_t at = 0; at < records.size(); at += size) {
        const TruthSums truth = readSums<TruthSums>(&records[at]);
        all.norm += truth.norm;
        all.noise += truth.noise;
        all.albedo += truth.albedo;
    }
    for (std::size_t f = 0; f < result.forms.size(); ++f) {
        MipError& error = result.forms[f];
        double distance = 0, albedo = 0;
        for (std::size_t at = 0; at < records.size(); at += size) {
            const double norm = readSums<TruthSums>(&records[at]).norm;
            const FormSums form = readSums<FormSums>(&records[at + recordSize(f)]);
            distance += form.distance;
            albedo += form.albedo;
            // Black texels have no norm.
            error.texels.push_back(norm > 0 ? std::sqrt(form.distance / norm) : 0);
            error.worstAlbedo = std::max(error.worstAlbedo, form.worstAlbedo);
            if (form.maximum <= error.maximum) continue;
            error.maximum = form.maximum;
            error.wi = form.wi;
            error.wo = form.wo;
        }
        if (!(all.norm > 0)) continue;
        error.relative = std::sqrt(distance / all.norm);
        error.albedo = albedo / all.albedo;
    }
    result.noise = all.norm > 0 ? std::sqrt(all.noise / all.norm) : 0;
}

}  // namespace

MipErrors measureMipLevel(const FilteredSurface& surface, int level, const MipLevel& filtered,
                          const LobeTable& table, const MipErrorOptions& options) {
    if (filtered.width != mipSize(surface.width, level) ||
        filtered.height != mipSize(surface.height, level))
        throw UsageError(fmt::format("level {} of {} x {} texels has {} x {}, not {} x {}", level,
                                     surface.width, surface.height, mipSize(surface.width, level),
                                     mipSize(surface.height, level), filtered.width,
                                     filtered.height));
    const std::size_t count = filtered.width * filtered.height;
    const std::vector<std::size_t> chosen =
        measuredTexels(filtered.width, filtered.height, options);
    const auto texel = [&](std::size_t k, std::mt19937_64& random) {
        // The first number of the generator spreads the texels.
        if (k == 0) uniform(random);
        const Footprint footprint =
            footprintOf(surface.width, surface.height, filtered.width, filtered.height, chosen[k]);
        MeasuredTexel result;
        result.base = sampled(surface, footprint, options.samples, random);
        result.all = result.base.size() == footprint.width * footprint.height;
        result.mean = meanTexel(surface, footprint);
        const auto numbers = filtered.texel(chosen[k] % filtered.width, chosen[k] / filtered.width);
        result.numbers.assign(numbers.begin(), numbers.end());
        return result;
    };
    return measureMipTexels(surface, filtered.layout, std::min(count, chosen.size()), texel, table,
                            options);
}

std::vector<std::size_t> measuredTexels(std::size_t width, std::size_t height,
                                        const MipErrorOptions& options) {
    if (options.samples < 4 || options.texels < 1 || options.outgoing < 1 || options.incoming < 4)
        throw UsageError(
            "errors of mip levels need at least 4 samples, 1 texel, 1 outgoing and 4 "
            "incoming directions");
    std::mt19937_64 random(options.seed);
    const std::size_t count = width * height;
    const std::size_t texels = std::min(count, static_cast<std::size_t>(options.texels));
    double at = uniform(random);
    std::vector<std::size_t> chosen;
    for (std::size_t k = 0; k < texels; ++k) {
        at = std::fmod(at + 0.6180339887498949, 1.0);
        chosen.push_back(
            count <= texels ? k : static_cast<std::size_t>(at * static_cast<double>(count)));
    }
    return chosen;
}

MipErrors measureMipTexels(
    const FilteredSurface& surface, const MipLayout& layout, std::size_t count,
    const std::function<MeasuredTexel(std::size_t k, std::mt19937_64& random)>& texel,
    const LobeTable& table, const MipErrorOptions& options, const MipErrorShare& share) {
    MipErrors result{.forms = formsOf(layout, options)};
    const std::size_t size = recordSize(result.forms.size());
    std::vector<double> records(count * size);
    std::mt19937_64 random(options.seed);
    const std::shared_ptr<const Basis> basis = bases::makeSh(layout.order, {});
    for (std::size_t k = 0; k < count; ++k) {
        if (k < share.first || k >= share.last) {
            random.discard(drawsOfPairs(options));
            continue;
        }
        const MeasuredTexel measured = texel(k, random);
        const std::vector<Facet> facets(measured.base.begin(), measured.base.end());
        const std::vector<Pair> pairs = pairsFor(measured.numbers, options, random);
        const Values values = valuesOf(surface, facets, Facet(measured.mean),
                                       FilteredTexel(layout, measured.numbers, table, basis),
                                       result.forms, pairs, measured.all, options.byVisibleArea);
        fillRecord(pairs, values,
                   {static_cast<std::size_t>(options.incoming),
                    static_cast<std::size_t>(surface.channels)},
                   &records[k * size]);
    }
    if (share.gather) share.gather(records);
    addRecords(records, result);
    return result;
}

const MipError& cheapestForm(const MipErrors& errors, double tolerance) {
    const auto better = [&](const MipError& a, const MipError& b) {
        const bool goodA = a.relative <= tolerance, goodB = b.relative <= tolerance;
        if (goodA != goodB) return goodA;
        return goodA ? a.numbers < b.numbers : a.relative < b.relative;
    };
    return *std::min_element(errors.forms.begin(), errors.forms.end(), better);
}

int orderFor(const MipLevel& level, double tolerance) {
    const MipLayout& layout = level.layout;
    std::vector<double> energies(static_cast<std::size_t>(layout.order / 2 + 1), 0.0);
    for (std::size_t at = 0; at < level.texels.size(); at += layout.size())
        for (int k = 0; k < layout.weights; ++k) {
            const double* c = &level.texels[at + layout.harmonics(k)];
            for (std::size_t band = 0; band < energies.size(); ++band)
                for (std::size_t i = 0; i < 4 * band + 1; ++i, ++c) energies[band] += *c * *c;
        }
    double all = 0, tail = 0;
    for (const double energy : energies) all += energy;
    std::size_t bands = energies.size();
    while (bands > 1 && tail + energies[bands - 1] <= tolerance * tolerance * all)
        tail += energies[--bands];
    return static_cast<int>(2 * bands) - 1;
}

}  // namespace hshfit::inline normal_filtering
