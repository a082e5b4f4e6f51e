#include <hshfit/rings.h>

#include <hshfit/error.h>
#include <hshfit/ring_kernels.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace hshfit {
namespace {

/// Values and coordinates of a block: three channels of 1024 points take 48 KiB, which the second
/// cache holds beside the tables; 512 to 4096 are equally good (bench/projection).
constexpr std::size_t blockValues = 6144, leastPoints = 64;

/// Rings with the same azimuths.
struct Run {
    std::size_t firstRing, rings, azimuths;
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
    std::vector<double> x, y, z, values, folded, spectrum, squares;
    AzimuthTable piece;
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
          columns_(tables.order()),
          result_(result) {}

    /// Points evaluated for each azimuth of a quadrant.
    std::size_t quadrants() const { return even_ ? 2 : 4; }

    void operator()(const Blocks& all, const Block& block) const {
        Lease lease;
        Workspace& w = *lease;
        if (const Run& run = all.runs[block.first]; !tables_.find(run.azimuths)) {
            byPieces(run, w);
            return;
        }
        std::size_t points = 0;
        for (std::size_t k = block.first; k < block.last; ++k) {
            fillDirections(all.runs[k], *tables_.find(all.runs[k].azimuths), points, w);
            points += pointsOf(all.runs[k]);
        }
        evaluate(points, w);
        std::size_t offset = 0;
        for (std::size_t k = block.first; k < block.last; ++k) {
            clear(all.runs[k], w);
            add(all.runs[k], *tables_.find(all.runs[k].azimuths), offset, points, w);
            store(all.runs[k], w);
            offset += pointsOf(all.runs[k]);
        }
    }

private:
    std::size_t pointsOf(const Run& run) const {
        return run.rings * quadrants() * (run.azimuths / 4);
    }

    /// A run whose table is too large to be kept.
    void byPieces(const Run& run, Workspace& w) const {
        const std::size_t quadrant = run.azimuths / 4;
        const std::size_t most = std::max<std::size_t>(
            blockValues / ((3 + result_.channels) * quadrants() * run.rings), leastPoints);
        clear(run, w);
        for (std::size_t first = 0; first < quadrant; first += most) {
            const std::size_t count = std::min(most, quadrant - first);
            w.piece.fill(tables_.order(), run.azimuths, first, count);
            fillDirections(run, w.piece, 0, w);
            const std::size_t points = run.rings * quadrants() * count;
            evaluate(points, w);
            add(run, w.piece, 0, points, w);
        }
        store(run, w);
    }

    void clear(const Run& run, Workspace& w) const {
        w.spectrum.assign(result_.channels * run.rings * columns_.all(), 0.0);
        w.squares.assign(run.rings, 0.0);
    }

    /// Ring by ring from number `offset`: phi, pi - phi, and unless even -phi, pi + phi.
    void fillDirections(const Run& run, const AzimuthTable& table, std::size_t offset,
                        Workspace& w) const {
        const std::size_t count = table.count, points = run.rings * quadrants() * count;
        growTo(w.x, offset + points);
        growTo(w.y, offset + points);
        growTo(w.z, offset + points);
        const RingDirections ring{table.cosine.data(), table.sine.data(), count, quadrants()};
        for (std::size_t r = run.firstRing; r < run.firstRing + run.rings; ++r) {
            fillRing(ring, grid_.sines[r], grid_.elevations[r].mu, w.x.data() + offset,
                     w.y.data() + offset, w.z.data() + offset);
            offset += count * quadrants();
        }
    }

    void evaluate(std::size_t points, Workspace& w) const {
        growTo(w.values, result_.channels * points);
        brdf_.eval(wo_, {w.x.data(), w.y.data(), w.z.data(), points}, w.values.data());
    }

    /// Adds a run's values, from number `offset` of `points` in each channel, to its spectrum.
    void add(const Run& run, const AzimuthTable& table, std::size_t offset, std::size_t points,
             Workspace& w) const {
        const std::size_t count = table.count, rows = result_.channels * run.rings;
        const std::size_t part = rows * count;
        growTo(w.folded, quadrants() * part);
        double sum = 0;
        for (std::size_t row = 0; row < rows; ++row) {
            const std::size_t channel = row / run.rings, ring = row % run.rings;
            double* c0 = w.folded.data() + row * count;
            const QuadrantFold fold{c0, c0 + part, c0 + 2 * part, c0 + 3 * part};
            const double* values =
                w.values.data() + channel * points + offset + ring * quadrants() * count;
            const double squares =
                even_ ? foldHalfRing(values, count, fold) : foldRing(values, count, fold);
            w.squares[ring] += squares;
            sum += squares;
        }
        if (!std::isfinite(sum)) requireFinite(w, points);

        const std::size_t kinds[] = {columns_.c0, columns_.c1, columns_.s1, columns_.s0};
        std::size_t column = 0;
        for (std::size_t k = 0; k < quadrants(); ++k) {
            addRowProducts({w.folded.data() + k * part, rows, count},
                           {table.rows.data() + column * count, kinds[k], count}, count,
                           w.spectrum.data() + column, columns_.all());
            column += kinds[k];
        }
    }

    /// Squares overflow before values do: only the values tell.
    void requireFinite(const Workspace& w, std::size_t points) const {
        const double* end = w.values.data() + result_.channels * points;
        const double* bad = std::find_if_not(static_cast<const double*>(w.values.data()), end,
                                             [](double v) { return std::isfinite(v); });
        if (bad == end) return;
        brdf_.checkIntact();  // bad data has its own, more exact message
        const std::size_t k = static_cast<std::size_t>(bad - w.values.data()) % points;
        const Direction wi{w.x[k], w.y[k], w.z[k]};
        throw NumericError(fmt::format(
            "{}: not finite at theta_i = {:.9g}, phi_i = {:.9g}, theta_o = {:.9g}, phi_o = {:.9g} "
            "degrees",
            brdf_.name(), degrees(polarAngle(wi)), degrees(azimuth(wi)), degrees(polarAngle(wo_)),
            degrees(azimuth(wo_))));
    }

    void store(const Run& run, const Workspace& w) const {
        const double weight = (even_ ? 4 : 2) * pi / static_cast<double>(run.azimuths);
        const int n = result_.order;
        for (std::size_t r = 0; r < run.rings; ++r) {
            const std::size_t ring = run.firstRing + r;
            const double cosine =
                quantity_ == Quantity::brdfCosine ? grid_.elevations[ring].mu : 1.0;
            for (std::size_t c = 0; c < result_.channels; ++c) {
                const double* from = w.spectrum.data() + (c * run.rings + r) * columns_.all();
                for (int m = even_ ? 0 : 1 - n; m < n; ++m)
                    result_.part(m, c)[ring] = weight * cosine * from[columns_.of(m)];
            }
            result_.squares[ring] = weight * cosine * cosine * w.squares[r];
        }
    }

    const Brdf& brdf_;
    const Direction& wo_;
    const HemisphereGrid& grid_;
    Quantity quantity_;
    const AzimuthTables& tables_;
    bool even_;
    AzimuthColumns columns_;
    RingSpectrum& result_;
};

/// As many rings, of neighbouring panels too, as make a block. Rings whose table is not kept stand
/// alone.
Blocks blocksOf(const HemisphereGrid& grid, const AzimuthTables& tables, std::size_t channels,
                bool even) {
    Blocks result;
    const std::size_t most = blockValues / (3 + channels);
    std::size_t filled = 0;
    for (const auto& panel : grid.panels) {
        const std::size_t points = panel.azimuths / (even ? 2 : 1);
        const bool kept = tables.find(panel.azimuths) != nullptr;
        for (std::size_t r = 0; r < panel.rings;) {
            const bool fits = kept && filled > 0 && filled + points <= most;
            if (!fits) {
                result.blocks.push_back({result.runs.size(), result.runs.size()});
                filled = 0;
            }
            const std::size_t together = std::clamp<std::size_t>(
                (most - std::min(filled, most)) / points, 1, panel.rings - r);
            result.runs.push_back({panel.firstRing + r, together, panel.azimuths});
            result.blocks.back().last = result.runs.size();
            filled = kept ? filled + together * points : 0;
            r += together;
        }
    }
    return result;
}

}  // namespace

void sampleRings(const Brdf& brdf, const Direction& wo, const HemisphereGrid& grid,
                 Quantity quantity, const AzimuthTables& tables, bool even, RingSpectrum& result) {
    result.order = tables.order();
    result.channels = brdf.channels().count();
    result.rings = grid.weights.size();
    result.evaluations = grid.points() / (even ? 2 : 1);
    result.parts.assign(2 * tables.order() * result.channels * result.rings, 0.0);
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

}  // namespace hshfit
