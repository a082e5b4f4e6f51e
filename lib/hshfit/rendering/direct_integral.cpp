#include <hshfit/rendering/direct_integral.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/rendering/internal/even_light.h>
#include <hshfit/rendering/internal/light_cells.h>
#include <hshfit/rendering/internal/panel_cells.h>
#include <hshfit/rendering/internal/smooth_light_nodes.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace hshfit::inline rendering {
namespace {

/// The direction about which f has a lobe, and the lobe's width in radians of wi.
struct Peak {
    Direction towards;
    double width = 1;
};

std::vector<Peak> peaksOf(const Brdf& brdf, const Direction& wo) {
    std::vector<Peak> peaks;
    for (const Lobe& lobe : brdf.lobes(wo)) {
        // A half vector turns by half of the angle by which wi does.
        if (lobe.about == Lobe::About::halfway)
            peaks.push_back({mirrored(wo), std::clamp(2 * lobe.width, 1e-3, 1.0)});
        else
            peaks.push_back({lobe.axis, std::clamp(lobe.width, 1e-3, 1.0)});
    }
    return peaks;
}

/// Four parts of a cell may all have their middles below the horizon, and light above it, so that
/// cells on the horizon are cut to this width, radians, in any case. Even light from cells of that
/// width about the horizon makes 2 width^2 of the irradiance.
double widestAtHorizon(double tolerance) {
    return std::min(0.2, 0.42 * std::sqrt(tolerance));
}

/// Whether a cell of so many nodes along a side is too wide beside a lobe for its four parts to
/// show what is there.
bool tooWide(double width, int nodesAcross, const Direction& local, std::span<const Peak> peaks) {
    return std::ranges::any_of(peaks, [&](const Peak& peak) {
        if (width <= nodesAcross * peak.width) return false;
        // The chord, which is no longer than the arc.
        const double x = local.x - peak.towards.x, y = local.y - peak.towards.y,
                     z = local.z - peak.towards.z;
        return width * width > 0.49 * (x * x + y * y + z * z);
    });
}

/// A sum over directions in R, G and B, and the magnitude of its terms below 0.
struct SignedSum {
    Rgb value{};
    double below = 0;
};

void add(Rgb& to, const Rgb& value) {
    for (std::size_t c = 0; c < 3; ++c) to[c] += value[c];
}
void add(SignedSum& to, const SignedSum& term) {
    add(to.value, term.value);
    to.below += term.below;
}
double magnitude(const Rgb& value) {
    return std::abs(value[0]) + std::abs(value[1]) + std::abs(value[2]);
}
double distance(const Rgb& a, const Rgb& b) {
    return std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2]);
}

/// The sum of the magnitudes of the terms, that the tolerance is a share of. Series of coefficients
/// are below 0 at places: their radiance may cancel to almost nothing, and a share of it would take
/// cells without end.
double scaleOf(const SignedSum& sum) {
    if (!(sum.below > 0)) return magnitude(sum.value);
    return sum.value[0] + sum.value[1] + sum.value[2] + 2 * sum.below;
}

/// f at directions of the frame, times cosine and flux.
class Evaluator {
public:
    Evaluator(const Brdf& brdf, const Direction& wo, PointRadiance& result)
        : brdf_(brdf), wo_(wo), channels_(brdf.channels().count()), result_(result) {}

    void clear() {
        for (auto* v : {&x_, &y_, &z_}) v->clear();
        flux_.clear();
    }
    void add(const Direction& local, const Rgb& flux) {
        x_.push_back(local.x);
        y_.push_back(local.y);
        z_.push_back(local.z);
        flux_.push_back(flux);
    }
    std::size_t count() const { return x_.size(); }
    void evaluate() {
        f_.resize(channels_ * x_.size());
        if (x_.empty()) return;
        brdf_.eval(wo_, {x_.data(), y_.data(), z_.data(), x_.size()}, f_.data());
        result_.evaluations += x_.size();
        for (double& value : f_) {
            if (std::isfinite(value)) continue;
            value = 0;
            ++result_.notFinite;
        }
    }
    /// The sum over directions first to last - 1.
    SignedSum sum(std::size_t first, std::size_t last) const {
        SignedSum sum;
        for (std::size_t k = first; k < last; ++k) {
            if (!(z_[k] > 0)) continue;
            for (std::size_t c = 0; c < 3; ++c) {
                const double value =
                    flux_[k][c] * z_[k] * f_[(channels_ == 1 ? 0 : c) * x_.size() + k];
                sum.value[c] += value;
                if (value < 0) sum.below -= value;
            }
        }
        return sum;
    }

private:
    const Brdf& brdf_;
    const Direction& wo_;
    std::size_t channels_;
    PointRadiance& result_;
    std::vector<double> x_, y_, z_, f_;
    std::vector<Rgb> flux_;
};

constexpr int nodesAcross(const LightCells&) {
    return 1;
}
constexpr int nodesAcross(const PanelCells&) {
    return PanelCells::nodesAcross;
}
void addNodes(const LightCells&, const LightCell& cell, const Direction& local, const Frame&,
              Evaluator& evaluator) {
    evaluator.add(local, cell.flux);
}
void addNodes(const PanelCells& cells, const PanelCell& cell, const Direction&, const Frame& frame,
              Evaluator& evaluator) {
    cells.nodesOf(cell, [&](const Direction& world, const Rgb& flux) {
        evaluator.add(frame.toLocal(world), flux);
    });
}

/// The integral over cells at one point, added to `total`.
template <class Cells, class Cell>
class CellIntegral {
public:
    CellIntegral(const Cells& cells, const Brdf& brdf, const Frame& frame, const Direction& wo,
                 const IntegrationOptions& options, SignedSum& total, PointRadiance& result)
        : cells_(cells),
          frame_(frame),
          options_(options),
          horizon_(nodesAcross(cells) * widestAtHorizon(options.tolerance)),
          peaks_(peaksOf(brdf, wo)),
          evaluator_(brdf, wo, result),
          total_(total),
          result_(result) {}

    void run() {
        std::vector<Item> frontier;
        for (const Cell& cell : cells_.coarse()) addItem(cell, frontier);
        evaluate(frontier);
        while (!frontier.empty()) frontier = refined(frontier);
    }

private:
    struct Item {
        Cell cell;
        Direction local;
        SignedSum sum = {};
    };

    /// Unless all of it is below the horizon.
    void addItem(const Cell& cell, std::vector<Item>& items) const {
        const Direction local = frame_.toLocal(cell.direction);
        if (local.z > -cell.width) items.push_back({cell, local});
    }
    void evaluate(std::vector<Item>& items) {
        evaluator_.clear();
        std::vector<std::size_t> first = {0};
        first.reserve(items.size() + 1);
        for (const Item& item : items) {
            addNodes(cells_, item.cell, item.local, frame_, evaluator_);
            first.push_back(evaluator_.count());
        }
        evaluator_.evaluate();
        for (std::size_t k = 0; k < items.size(); ++k)
            items[k].sum = evaluator_.sum(first[k], first[k + 1]);
    }

    /// Cuts every cell once. Parts that agree with their whole are added to the result; the others
    /// are returned.
    std::vector<Item> refined(const std::vector<Item>& whole) {
        std::vector<Item> parts;
        parts.reserve(4 * whole.size());
        std::vector<std::size_t> first = {0};
        std::array<Cell, 4> four;
        for (const Item& item : whole) {
            const std::size_t count = cells_.split(item.cell, four);
            for (std::size_t k = 0; k < count; ++k) addItem(four[k], parts);
            if (count == 0) parts.push_back(item);
            first.push_back(parts.size());
        }
        evaluate(parts);

        std::vector<SignedSum> sums(whole.size());
        SignedSum estimate = total_;
        double open = 0;
        bool wide = false;
        std::vector<double> differences(whole.size());
        std::vector<char> forced(whole.size(), 0);
        for (std::size_t k = 0; k < whole.size(); ++k) {
            for (std::size_t i = first[k]; i < first[k + 1]; ++i) {
                add(sums[k], parts[i].sum);
                const double width = parts[i].cell.width;
                const bool onHorizon = width > horizon_ && std::abs(parts[i].local.z) < width;
                if (onHorizon || tooWide(width, nodesAcross(cells_), parts[i].local, peaks_))
                    forced[k] = 1;
            }
            if (first[k + 1] == first[k] + 1 && parts[first[k]].cell.width == whole[k].cell.width)
                forced[k] = 0;  // a cell that is not cut
            add(estimate, sums[k]);
            differences[k] = distance(whole[k].sum.value, sums[k].value);
            open += differences[k];
            wide = wide || forced[k] != 0;
        }
        const double allowed = options_.tolerance * scaleOf(estimate) / 2;
        result_.cut = result_.evaluations > options_.maxEvaluations;
        const bool all = result_.cut || (!wide && open <= allowed);
        const double each = allowed / static_cast<double>(whole.size());
        std::vector<Item> next;
        for (std::size_t k = 0; k < whole.size(); ++k) {
            if (all || (!forced[k] && differences[k] <= each)) {
                add(total_, sums[k]);
                result_.error += differences[k];
            } else {
                next.insert(next.end(), parts.begin() + static_cast<std::ptrdiff_t>(first[k]),
                            parts.begin() + static_cast<std::ptrdiff_t>(first[k + 1]));
            }
        }
        return next;
    }

    const Cells& cells_;
    const Frame& frame_;
    const IntegrationOptions& options_;
    const double horizon_;
    const std::vector<Peak> peaks_;
    Evaluator evaluator_;
    SignedSum& total_;
    PointRadiance& result_;
};

/// The largest angle from side to side of a light that is sampled by nodes.
double extentOf(const Light& light) {
    if (const auto* disc = std::get_if<DiscLight>(&light)) return 2 * disc->radius;
    if (std::holds_alternative<CoefficientLight>(light)) return pi;
    return 0;
}

constexpr int mostLevel = 12;

/// Share of a picture's flux times width, in radians, of its coarse cells, over the tolerance.
constexpr double finestPerTolerance = 0.1;

/// DirectIntegral::finest of a light.
double finestOf(const Light& light) {
    if (const auto* series = std::get_if<CoefficientLight>(&light))
        return pi / 2 / series->coefficients->order;
    const auto* sky = std::get_if<SkyLight>(&light);
    if (!sky || sky->model == SkyLight::Model::hosekWilkie) return 0;
    double finest = 1;
    for (const SkyShape& shape : sky->shapes)
        finest = std::min(finest, 1 / std::max(1.0, std::abs(shape.d)));
    return finest;
}

/// The level at which nodes are as close as the narrowest lobe is wide, or seven tenths of the
/// distance from a disc to its peak.
int firstLevel(const Light& light, const Frame& frame, std::span<const Peak> peaks) {
    const double extent = extentOf(light);
    double narrowest = 1;
    for (const Peak& peak : peaks) {
        double away = 0;
        if (const auto* disc = std::get_if<DiscLight>(&light))
            away = angleBetween(frame.toLocal(disc->towards), peak.towards) - disc->radius;
        narrowest = std::min(narrowest, std::max(peak.width, 0.7 * away));
    }
    const double more = extent / (narrowest * (3 + 2 * extent));
    return more <= 1 ? 0
                     : std::min(mostLevel - 1,
                                static_cast<int>(std::ceil(std::log(more) / std::log(1.5))));
}

/// The first level at which nodes that follow a light are more than nodes that follow lobes.
constexpr int fineLevel = 2;

/// Whether nodes for a light that would start at this level follow the lobes of f instead.
bool followsLobes(const Light& light, int level) {
    const bool smooth =
        std::holds_alternative<DiscLight>(light) || std::holds_alternative<CoefficientLight>(light);
    return evenRadianceOf(light).has_value() || (smooth && level >= fineLevel);
}

}  // namespace

struct DirectIntegral::Parts {
    Parts(std::span<const Light> lights, double tolerance)
        : Parts(withOneSky(lights), finestPerTolerance * tolerance, lights) {}
    /// `lights` with pictures for skies.
    Parts(const std::vector<Light>& lights, double share, std::span<const Light> given)
        : cells(lights, share), panels(lights) {
        for (const Light& light : given) finest = std::min(finest, finestOf(light));
        for (const Light& light : lights) {
            if (!std::holds_alternative<PictureLight>(light) &&
                !std::holds_alternative<PanelLight>(light))
                compact.push_back(light);
        }
    }
    LightCells cells;
    PanelCells panels;
    double finest = 1;
    std::vector<Light> compact;  ///< discs, directional lights, series
};

DirectIntegral::DirectIntegral(std::span<const Light> lights, double tolerance)
    : parts_(std::make_unique<Parts>(lights, tolerance)) {}
DirectIntegral::~DirectIntegral() = default;

double DirectIntegral::finest() const {
    return parts_->finest;
}

Rgb DirectIntegral::evenRadiance() const {
    Rgb sum{};
    for (const Light& light : parts_->compact)
        if (const auto radiance = evenRadianceOf(light)) add(sum, *radiance);
    return sum;
}

PointRadiance DirectIntegral::at(const Brdf& brdf, const Frame& frame, const Direction& wo,
                                 const IntegrationOptions& options,
                                 const std::optional<PointRadiance>& underEven) const {
    PointRadiance result;
    SignedSum total;
    CellIntegral<LightCells, LightCell>(parts_->cells, brdf, frame, wo, options, total, result)
        .run();
    CellIntegral<PanelCells, PanelCell>(parts_->panels, brdf, frame, wo, options, total, result)
        .run();
    Evaluator evaluator(brdf, wo, result);
    const std::vector<Peak> peaks =
        parts_->compact.empty() ? std::vector<Peak>{} : peaksOf(brdf, wo);
    if (underEven) {
        for (std::size_t c = 0; c < 3; ++c) total.value[c] += underEven->radiance[c];
        result.error += underEven->error;
    }
    for (const Light& light : parts_->compact) {
        if (underEven && evenRadianceOf(light)) continue;
        int level = firstLevel(light, frame, peaks);
        std::optional<SmoothLightNodes> nodes;
        if (followsLobes(light, level)) {
            nodes.emplace(light, frame, brdf, wo);
            level = nodes->firstLevel(options.tolerance);
        }
        const auto sumAt = [&](int at) {
            const LightSamples samples =
                nodes ? nodes->samples(at) : sampleLights({&light, 1}, frame, at);
            evaluator.clear();
            for (std::size_t k = 0; k < samples.count(); ++k) {
                evaluator.add({samples.x[k], samples.y[k], samples.z[k]},
                              {samples.flux[0][k], samples.flux[1][k], samples.flux[2][k]});
            }
            evaluator.evaluate();
            return evaluator.sum(0, evaluator.count());
        };
        SignedSum sum = sumAt(level);
        if (std::holds_alternative<DirectionalLight>(light)) {
            add(total, sum);
            continue;
        }
        double difference = 0;
        while (true) {
            const SignedSum finer = sumAt(++level);
            difference = distance(sum.value, finer.value);
            sum = finer;
            if (difference <= options.tolerance * (scaleOf(total) + scaleOf(sum)) / 2) break;
            result.cut = result.cut || result.evaluations > options.maxEvaluations;
            if (level >= mostLevel || result.cut) break;
        }
        add(total, sum);
        result.error += difference;
    }
    result.radiance = total.value;
    return result;
}

}  // namespace hshfit::inline rendering
