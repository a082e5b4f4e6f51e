#include <hshfit/projection/internal/rings.h>

#include <hshfit/error.h>
#include <hshfit/projection/internal/ring_kernels.h>
#include <hshfit/projection/lane_products.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

namespace hshfit::inline projection {
namespace {

/// Values and coordinates of a block: three channels of 1024 points take 48 KiB, which the second
/// cache holds beside the tables; 512 to 4096 are equally good (bench/projection).
constexpr std::size_t blockValues = 6144, leastPoints = 64;

/// Neighbouring rings of one panel.
struct Run {
    const HemisphereGrid::Panel* panel;
    std::shared_ptr<const AzimuthTable> table;  ///< none where it is too large
    std::size_t firstRing, rings;

    const AzimuthSpacing& spacing() const { return panel->azimuths.spacing; }
    bool cut() const { return !panel->cuts.empty(); }
    const CutRing& cutRing(std::size_t ring) const { return panel->cuts[ring - panel->firstRing]; }
    Run ring(std::size_t k) const { return {panel, nullptr, firstRing + k, 1}; }
    /// Azimuths of half of the circle and their mirror images.
    bool halves() const { return cut() || spacing().squeeze > 0; }
};

/// Runs that are evaluated in one call, numbers first to last - 1.
struct Block {
    std::size_t first, last;
};

struct Blocks {
    std::vector<Run> runs;
    std::vector<Block> blocks;
};

/// The buffers of one block. BRDFs may wait for other work within eval, so that a thread can need
/// more than one: Lease.
struct Workspace {
    std::vector<double> x, y, z, values, folded;
    AzimuthTable piece;
    std::vector<AzimuthTable> ofRings;
    std::vector<double> nodes, nodeWeights;
};

class Lease {
public:
    Lease() {
        if (free().empty()) free().push_back(std::make_unique<Workspace>());
        workspace_ = std::move(free().back());
        free().pop_back();
    }
    ~Lease() { free().push_back(std::move(workspace_)); }
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    Workspace& operator*() { return *workspace_; }

private:
    static std::vector<std::unique_ptr<Workspace>>& free() {
        thread_local std::vector<std::unique_ptr<Workspace>> workspaces;
        return workspaces;
    }
    std::unique_ptr<Workspace> workspace_;
};

template <class T>
void growTo(std::vector<T>& v, std::size_t size) {
    if (v.size() < size) v.resize(size);
}

class Sampler {
public:
    Sampler(const Brdf& brdf, const Direction& wo, const HemisphereGrid& grid, Quantity quantity,
            const AzimuthTables& tables, bool even, RingSpectrum& result)
        : brdf_(brdf),
          wo_(wo),
          grid_(grid),
          quantity_(quantity),
          tables_(tables),
          even_(even),
          result_(result) {}

    void operator()(const Blocks& all, const Block& block) const {
        Lease lease;
        Workspace& w = *lease;
        if (const Run& run = all.runs[block.first]; !run.table) {
            run.cut() ? byCuts(run, w) : byPieces(run, w);
            return;
        }
        std::size_t points = 0;
        for (std::size_t k = block.first; k < block.last; ++k) {
            fillDirections(all.runs[k], *all.runs[k].table, points, w);
            points += pointsOf(all.runs[k]);
        }
        evaluate(points, w);
        std::size_t offset = 0;
        for (std::size_t k = block.first; k < block.last; ++k) {
            add(all.runs[k], *all.runs[k].table, offset, points, w);
            weight(all.runs[k]);
            offset += pointsOf(all.runs[k]);
        }
    }

private:
    /// Points evaluated for each azimuth of the run's table: one for each quadrant, or for each
    /// half of the circle, and half of them where q is even.
    std::size_t copies(const Run& run) const { return (run.halves() ? 2 : 4) / (even_ ? 2 : 1); }
    std::size_t pointsOf(const Run& run) const {
        return run.rings * copies(run) * tableSize(run.spacing());
    }

    /// A run whose table is too large.
    void byPieces(const Run& run, Workspace& w) const {
        const std::size_t whole = tableSize(run.spacing());
        const std::size_t most = std::max<std::size_t>(
            blockValues / ((3 + result_.channels) * copies(run) * run.rings), leastPoints);
        for (std::size_t first = 0; first < whole; first += most) {
            const std::size_t count = std::min(most, whole - first);
            w.piece.fill(tables_.order(), run.spacing(), first, count);
            fillDirections(run, w.piece, 0, w);
            const std::size_t points = run.rings * copies(run) * count;
            evaluate(points, w);
            add(run, w.piece, 0, points, w);
        }
        weight(run);
    }

    /// Rings that curves cross, each of which has a table of its own. A ring alone may have too
    /// many nodes for one.
    void byCuts(const Run& run, Workspace& w) const {
        const std::size_t most = blockValues / ((3 + result_.channels) * copies(run));
        if (run.rings == 1 && run.cutRing(run.firstRing).size() > most) {
            std::vector<double> nodes, weights;  // `w` may serve another ring while f is evaluated
            run.cutRing(run.firstRing).nodes(nodes, weights);
            for (std::size_t first = 0; first < nodes.size(); first += most) {
                const std::size_t count = std::min(most, nodes.size() - first);
                w.piece.fill(tables_.order(), run.spacing(), std::span(nodes).subspan(first, count),
                             std::span(weights).subspan(first, count));
                fillDirections(run, w.piece, 0, w);
                evaluate(copies(run) * count, w);
                add(run, w.piece, 0, copies(run) * count, w);
            }
            weight(run);
            return;
        }
        growTo(w.ofRings, run.rings);
        std::size_t points = 0;
        for (std::size_t k = 0; k < run.rings; ++k) {
            const Run ring = run.ring(k);
            run.cutRing(ring.firstRing).nodes(w.nodes, w.nodeWeights);
            w.ofRings[k].fill(tables_.order(), run.spacing(), w.nodes, w.nodeWeights);
            fillDirections(ring, w.ofRings[k], points, w);
            points += copies(run) * w.ofRings[k].count;
        }
        evaluate(points, w);
        std::size_t offset = 0;
        for (std::size_t k = 0; k < run.rings; ++k) {
            add(run.ring(k), w.ofRings[k], offset, points, w);
            offset += copies(run) * w.ofRings[k].count;
        }
        weight(run);
    }

    /// Ring by ring from number `offset`: phi, pi - phi, and unless even -phi, pi + phi; about the
    /// centre of clustered azimuths phi, and unless even -phi.
    void fillDirections(const Run& run, const AzimuthTable& table, std::size_t offset,
                        Workspace& w) const {
        const std::size_t ring = copies(run) * table.count, points = run.rings * ring;
        growTo(w.x, offset + points);
        growTo(w.y, offset + points);
        growTo(w.z, offset + points);
        const RingDirections directions{.cosine = table.cosine.data(),
                                        .sine = table.sine.data(),
                                        .count = table.count,
                                        .copies = copies(run),
                                        .centreX = run.panel->azimuths.centreX,
                                        .centreY = run.panel->azimuths.centreY};
        const auto fill = run.halves() ? fillSqueezedRing : fillRing;
        for (std::size_t r = run.firstRing; r < run.firstRing + run.rings; ++r, offset += ring) {
            fill(directions, grid_.sines[r], grid_.elevations[r].mu, w.x.data() + offset,
                 w.y.data() + offset, w.z.data() + offset);
        }
    }

    void evaluate(std::size_t points, Workspace& w) const {
        growTo(w.values, result_.channels * points);
        brdf_.eval(wo_, {w.x.data(), w.y.data(), w.z.data(), points}, w.values.data());
    }

    /// Adds a run's values, from number `offset` of `points` in each channel, to its spectrum.
    void add(const Run& run, const AzimuthTable& table, std::size_t offset, std::size_t points,
             Workspace& w) const {
        const std::size_t count = table.count, part = run.rings * count;
        const AzimuthColumns& columns = result_.columns;
        std::array<std::size_t, 4> kinds = {columns.c0, columns.c1, columns.s1, columns.s0};
        if (run.halves()) kinds = {columns.c0 + columns.c1, columns.s1 + columns.s0};
        growTo(w.folded, copies(run) * part);
        double sum = 0;
        for (std::size_t channel = 0; channel < result_.channels; ++channel) {
            const double* values = w.values.data() + channel * points + offset;
            for (std::size_t ring = 0; ring < run.rings; ++ring) {
                const double squares = fold(run, table, values + ring * copies(run) * count, part,
                                            w.folded.data() + ring * count);
                result_.squares[run.firstRing + ring] += squares;
                sum += squares;
            }
            double* to =
                result_.parts.data() + run.firstRing * result_.ringSize() + channel * columns.all();
            const double *azimuths = table.rows.data(), *from = w.folded.data();
            for (std::size_t k = 0; k < copies(run); ++k, from += part) {
                addProducts({from, run.rings, count}, {azimuths, kinds[k], columns.all()}, count,
                            to, result_.ringSize());
                azimuths += kinds[k];
                to += kinds[k];
            }
        }
        if (!std::isfinite(sum)) requireFinite(w, points);
    }

    /// One ring into sums, one for each kind, `part` apart; returns the sum of squares.
    double fold(const Run& run, const AzimuthTable& table, const double* values, std::size_t part,
                double* to) const {
        const QuadrantFold folded{to, to + part, to + 2 * part, to + 3 * part};
        if (!run.halves())
            return even_ ? foldHalfRing(values, table.count, folded)
                         : foldRing(values, table.count, folded);
        const double* weights = table.weights.data();
        return foldSqueezedRing(values, weights, table.count, to, even_ ? nullptr : to + part);
    }

    /// Refuses values that are not finite, or whose squares are not: no refinement would end well.
    void requireFinite(const Workspace& w, std::size_t points) const {
        const auto end = w.values.begin() + static_cast<std::ptrdiff_t>(result_.channels * points);
        auto bad =
            std::find_if_not(w.values.begin(), end, [](double v) { return std::isfinite(v); });
        const bool finite = bad == end;
        if (finite) {
            bad = std::max_element(w.values.begin(), end,
                                   [](double a, double b) { return std::abs(a) < std::abs(b); });
        }
        brdf_.checkIntact();  // bad data has its own, more exact message
        const std::size_t k = static_cast<std::size_t>(bad - w.values.begin()) % points;
        const Direction wi{w.x[k], w.y[k], w.z[k]};
        throw NumericError(fmt::format(
            "{}: {} at theta_i = {:.9g}, phi_i = {:.9g}, theta_o = {:.9g}, phi_o = {:.9g} degrees",
            brdf_.name(),
            finite ? fmt::format("{:.4g}, whose square is beyond double precision,", *bad)
                   : "not finite",
            degrees(polarAngle(wi)), degrees(azimuth(wi)), degrees(polarAngle(wo_)),
            degrees(azimuth(wo_))));
    }

    /// Sums over azimuths become integrals of q.
    void weight(const Run& run) const {
        const double step =
            run.cut() ? (even_ ? 2 : 1)
                      : (even_ ? 4 : 2) * pi / static_cast<double>(run.spacing().azimuths);
        for (std::size_t ring = run.firstRing; ring < run.firstRing + run.rings; ++ring) {
            const double cosine =
                quantity_ == Quantity::brdfCosine ? grid_.elevations[ring].mu : 1.0;
            double* parts = result_.parts.data() + ring * result_.ringSize();
            for (std::size_t k = 0; k < result_.ringSize(); ++k) parts[k] *= step * cosine;
            result_.squares[ring] *= step * cosine * cosine;
        }
        if (run.halves() && tables_.order() > 1) turn(run);
    }

    /// Turns coefficients from azimuths about the panel's centre to azimuths about the x axis.
    void turn(const Run& run) const {
        const double x = run.panel->azimuths.centreX, y = run.panel->azimuths.centreY;
        const AzimuthColumns& columns = result_.columns;
        double* first = result_.parts.data() + run.firstRing * result_.ringSize();
        double* end = first + run.rings * result_.ringSize();
        double re = 1, im = 0;
        for (int m = 1; m < tables_.order(); ++m) {
            const double next = re * x - im * y;
            im = re * y + im * x;
            re = next;
            const std::size_t even = columns.of(m), odd = columns.of(-m);
            for (double* parts = first; parts < end; parts += columns.all()) {
                const double before = parts[even];
                parts[even] = re * before - im * parts[odd];
                parts[odd] = im * before + re * parts[odd];
            }
        }
    }

    const Brdf& brdf_;
    const Direction& wo_;
    const HemisphereGrid& grid_;
    Quantity quantity_;
    const AzimuthTables& tables_;
    bool even_;
    RingSpectrum& result_;
};

/// Rings of a panel that curves cross, in blocks with at most that many nodes of half circles.
void addCutRings(const HemisphereGrid::Panel& panel, std::size_t most, Blocks& result) {
    for (std::size_t r = 0; r < panel.rings;) {
        std::size_t nodes = panel.cuts[r].size(), together = 1;
        while (r + together < panel.rings && nodes + panel.cuts[r + together].size() <= most)
            nodes += panel.cuts[r + together++].size();
        result.blocks.push_back({result.runs.size(), result.runs.size() + 1});
        result.runs.push_back({&panel, nullptr, panel.firstRing + r, together});
        r += together;
    }
}

/// Groups of rings, across neighbouring panels, that make a block. A ring whose table is too large
/// is a group of its own.
Blocks blocksOf(const HemisphereGrid& grid, const AzimuthTables& tables, std::size_t channels,
                bool even) {
    Blocks result;
    const std::size_t most = blockValues / (3 + channels);
    std::size_t filled = 0;
    for (const auto& panel : grid.panels) {
        if (!panel.cuts.empty()) {
            addCutRings(panel, even ? most : most / 2, result);
            filled = 0;
            continue;
        }
        const std::size_t points = panel.azimuths.spacing.azimuths / (even ? 2 : 1);
        const auto table = tables.find(panel.azimuths.spacing);
        for (std::size_t r = 0; r < panel.rings;) {
            const bool fits = table && filled > 0 && filled + points <= most;
            if (!fits) {
                result.blocks.push_back({result.runs.size(), result.runs.size()});
                filled = 0;
            }
            const std::size_t together = std::clamp<std::size_t>(
                (most - std::min(filled, most)) / points, 1, panel.rings - r);
            result.runs.push_back({&panel, table, panel.firstRing + r, together});
            result.blocks.back().last = result.runs.size();
            filled = table ? filled + together * points : 0;
            r += together;
        }
    }
    return result;
}

}  // namespace

void sampleRings(const Brdf& brdf, const Direction& wo, const HemisphereGrid& grid,
                 Quantity quantity, const AzimuthTables& tables, bool even, RingSpectrum& result) {
    result.columns = AzimuthColumns(tables.order());
    result.channels = brdf.channels().count();
    result.rings = grid.weights.size();
    result.evaluations = grid.points() / (even ? 2 : 1);
    result.parts.assign(result.rings * result.ringSize(), 0.0);
    result.squares.assign(result.rings, 0.0);

    const Blocks all = blocksOf(grid, tables, result.channels, even);
    const Sampler sampler(brdf, wo, grid, quantity, tables, even, result);
    constexpr std::size_t tooFew = 16384;  // evaluations that are not worth sharing
    if (result.evaluations < tooFew) {
        for (const Block& block : all.blocks) sampler(all, block);
        return;
    }
    tbb::parallel_for(std::size_t{0}, all.blocks.size(),
                      [&](std::size_t b) { sampler(all, all.blocks[b]); });
}

}  // namespace hshfit::inline projection
