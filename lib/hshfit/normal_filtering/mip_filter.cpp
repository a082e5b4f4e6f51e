#include <hshfit/normal_filtering/mip_filter.h>

#include <hshfit/bases/sh.h>
#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>
#include <hshfit/normal_filtering/internal/mip_box.h>
#include <hshfit/normal_filtering/surface_frame.h>
#include <hshfit/rotation/sh_rotation.h>

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <deque>

namespace hshfit::inline normal_filtering {
namespace {

/// Texels of a row that one task filters.
constexpr std::size_t blockTexels = 64;

bool finite(const Direction& d) {
    return std::isfinite(d.x) && std::isfinite(d.y) && std::isfinite(d.z);
}

/// The complaint about a texel, empty for one that can be filtered.
std::string complaint(const SurfaceTexel& t, const MipLayout& layout, bool anisotropic) {
    const double length = std::sqrt(dot(t.normal, t.normal));
    if (!finite(t.normal) || !(length > 1e-30) || !std::isfinite(length))
        return fmt::format("the normal is ({}, {}, {}); a finite vector other than 0 is needed",
                           t.normal.x, t.normal.y, t.normal.z);
    if (anisotropic) {
        const double along = dot(t.normal, t.tangent) / length;
        const double square = dot(t.tangent, t.tangent);
        if (!finite(t.tangent) || !(square - along * along > 1e-12 * square))
            return fmt::format(
                "the tangent is ({}, {}, {}); a finite vector that is not along the normal is "
                "needed",
                t.tangent.x, t.tangent.y, t.tangent.z);
    }
    if (!std::isfinite(t.lobe[0]) || !std::isfinite(t.lobe[1]))
        return fmt::format("the place of its lobe is ({}, {}); finite numbers are needed",
                           t.lobe[0], t.lobe[1]);
    const auto bad = [](double v) { return !std::isfinite(v) || v < 0; };
    for (int k = 0; k < layout.weights; ++k)
        if (bad(t.weights[static_cast<std::size_t>(k)]))
            return fmt::format("weight {} is {}; a finite number of at least 0 is needed", k,
                               t.weights[static_cast<std::size_t>(k)]);
    for (int k = 0; k < layout.albedos; ++k)
        if (bad(t.albedos[static_cast<std::size_t>(k)]))
            return fmt::format("albedo {} is {}; a finite number of at least 0 is needed", k,
                               t.albedos[static_cast<std::size_t>(k)]);
    return {};
}

/// Everything but the harmonics of one texel, added with a share.
void addMoments(const SurfaceTexel& t, const Direction& n, const SurfaceFrame& frame,
                const std::array<double, 2>& widths, const MipLayout& layout, const double* y,
                double share, double* out) {
    const auto add = [&](std::size_t at, double value) { out[at] += share * value; };
    add(MipLayout::normal, n.x);
    add(MipLayout::normal + 1, n.y);
    add(MipLayout::normal + 2, n.z);
    const PlanePoint u = toPlane(n);
    add(MipLayout::plane, u[0]);
    add(MipLayout::plane + 1, u[1]);
    add(MipLayout::planeSquares, u[0] * u[0]);
    add(MipLayout::planeSquares + 1, u[0] * u[1]);
    add(MipLayout::planeSquares + 2, u[1] * u[1]);
    const PlanePoint e = toPlaneDirection(n, frame.x);
    const double xx = widths[0] * widths[0], yy = widths[1] * widths[1];
    add(MipLayout::widths, xx * e[0] * e[0] + yy * e[1] * e[1]);
    add(MipLayout::widths + 1, (xx - yy) * e[0] * e[1]);
    add(MipLayout::widths + 2, xx * e[1] * e[1] + yy * e[0] * e[0]);
    add(MipLayout::lobe, t.lobe[0]);
    add(MipLayout::lobe + 1, t.lobe[1]);
    for (int k = 0; k < layout.weights; ++k)
        add(MipLayout::weight + static_cast<std::size_t>(k),
            t.weights[static_cast<std::size_t>(k)]);
    for (int k = 0; k < layout.albedos; ++k)
        for (std::size_t i = 0; i < 9; ++i)
            add(layout.albedo(k) + i, t.albedos[static_cast<std::size_t>(k)] * y[i]);
}

}  // namespace

struct MipFilter::Work {
    struct Level {
        std::size_t width, height;
        std::size_t next = 0;   ///< row of the level above that is made next
        std::size_t end = 0;    ///< rows of the level above that are made end here
        std::size_t first = 0;  ///< row of held.front()
        MipRows own = {};       ///< rows that leave
        std::deque<std::vector<double>> held = {};
    };

    std::size_t width = 0, height = 0, received = 0, last = 0;  ///< rows of the base
    std::shared_ptr<const LobeTable> table;
    MipLayout layout;
    Sink sink;
    std::unique_ptr<Basis> basis;  // of at least three bands
    std::unique_ptr<ShRotation> rotation;
    std::deque<std::vector<SurfaceTexel>> held = {};  // rows of the base
    std::size_t firstHeld = 0;
    std::vector<Level> levels = {};  // the levels that are made; [0] is the base

    void addHarmonics(std::span<const SurfaceTexel> row, std::size_t first, std::size_t count,
                      std::vector<double>& out) const;
    void addBlock(std::span<const SurfaceTexel> row, double shareOfRow, std::size_t from,
                  std::size_t to, double* out) const;
    std::vector<double> firstRow(std::size_t y) const;
    void reduce(std::size_t level);
    void emit(std::size_t level, std::vector<double> row);
};

/// Writes the coefficients of D turned to each of `count` texels, in slots l(l+1) + m. For an
/// isotropic table `out` has the Y_(l,m) of the normals before, which are multiplied by the zonal
/// coefficients.
void MipFilter::Work::addHarmonics(std::span<const SurfaceTexel> row, std::size_t first,
                                   std::size_t count, std::vector<double>& out) const {
    const auto slots = static_cast<std::size_t>(basis->slots());
    if (table->isotropic()) {
        std::vector<double> zonal(static_cast<std::size_t>(layout.order / 2 + 1));
        LobePlace last{std::nan(""), 0};
        for (std::size_t k = 0; k < count; ++k) {
            const LobePlace& place = row[first + k].lobe;
            if (place != last) {
                table->zonal(place, zonal);
                for (std::size_t b = 0; b < zonal.size(); ++b)
                    zonal[b] *= std::sqrt(4 * pi / (4.0 * static_cast<double>(b) + 1));
                last = place;
            }
            for (int l = 0; l < layout.order; l += 2) {
                double* band = &out[k * slots + static_cast<std::size_t>(l * l)];
                for (int i = 0; i < 2 * l + 1; ++i)
                    band[i] *= zonal[static_cast<std::size_t>(l / 2)];
            }
        }
        return;
    }
    std::vector<Rotation> turns(count);
    for (std::size_t k = 0; k < count; ++k) {
        const SurfaceTexel& t = row[first + k];
        const SurfaceFrame f(t.normal, t.tangent);
        turns[k] =
            Rotation::fromMatrix({f.x.x, f.y.x, f.z.x, f.x.y, f.y.y, f.z.y, f.x.z, f.y.z, f.z.z});
        table->coefficients(t.lobe, std::span(out).subspan(k * slots, slots));
    }
    rotation->rotate(turns, 1, out.data(), out.data());
}

/// Texels `from` … `to` of a row above, in `out`, from one row of the base.
void MipFilter::Work::addBlock(std::span<const SurfaceTexel> row, double shareOfRow,
                               std::size_t from, std::size_t to, double* out) const {
    const std::size_t first = boxOf(from, width).first, end = boxOf(to - 1, width).end();
    const std::size_t count = end - first;
    std::vector<double> x(count), y(count), z(count);
    for (std::size_t k = 0; k < count; ++k) {
        const Direction n = normalised(row[first + k].normal);
        x[k] = n.x;
        y[k] = n.y;
        z[k] = n.z;
    }
    const auto slots = static_cast<std::size_t>(basis->slots());
    std::vector<double> values(count * slots);
    basis->evaluate({x.data(), y.data(), z.data(), count}, values.data());
    std::vector<double> low(count * 9);
    for (std::size_t k = 0; k < count; ++k) std::copy_n(&values[k * slots], 9, &low[k * 9]);
    if (layout.weights > 0) addHarmonics(row, first, count, values);
    for (std::size_t at = from; at < to; ++at) {
        const Box box = boxOf(at, width);
        double* texel = out + (at - from) * layout.size();
        for (std::size_t s = 0; s < box.count; ++s) {
            const std::size_t k = box.first + s - first;
            const SurfaceTexel& t = row[first + k];
            const double share = shareOfRow * box.shares[s];
            const SurfaceFrame frame({x[k], y[k], z[k]}, t.tangent);
            addMoments(t, frame.z, frame, table->widths(t.lobe), layout, &low[k * 9], share, texel);
            for (int w = 0; w < layout.weights; ++w) {
                const double factor = share * t.weights[static_cast<std::size_t>(w)];
                double* c = texel + layout.harmonics(w);
                for (int l = 0; l < layout.order; l += 2) {
                    const double* band = &values[k * slots + static_cast<std::size_t>(l * l)];
                    for (int i = 0; i < 2 * l + 1; ++i) *c++ += factor * band[i];
                }
            }
        }
    }
}

/// Row y of level 1 from the rows of the base that are held.
std::vector<double> MipFilter::Work::firstRow(std::size_t y) const {
    const std::size_t above = mipSize(width, 1);
    std::vector<double> out(above * layout.size(), 0.0);
    const Box box = boxOf(y, height);
    eachInParallel((above + blockTexels - 1) / blockTexels, [&](std::size_t block) {
        const std::size_t from = block * blockTexels, to = std::min(above, from + blockTexels);
        for (std::size_t s = 0; s < box.count; ++s)
            addBlock(held[box.first + s - firstHeld], box.shares[s], from, to,
                     &out[from * layout.size()]);
    });
    return out;
}

/// Rows of `level` + 1, as many as the rows held of `level` allow.
void MipFilter::Work::reduce(std::size_t level) {
    Level& below = levels[level];
    const std::size_t size = layout.size(), above = levels[level + 1].width;
    while (below.next < below.end) {
        const Box box = boxOf(below.next, below.height);
        if (box.end() > below.first + below.held.size()) return;
        std::vector<double> out(above * size, 0.0);
        eachInParallel((above + blockTexels - 1) / blockTexels, [&](std::size_t block) {
            const std::size_t end = std::min(above, (block + 1) * blockTexels);
            for (std::size_t s = 0; s < box.count; ++s) {
                const std::vector<double>& row = below.held[box.first + s - below.first];
                for (std::size_t at = block * blockTexels; at < end; ++at) {
                    const Box across = boxOf(at, below.width);
                    for (std::size_t k = 0; k < across.count; ++k) {
                        const double share = box.shares[s] * across.shares[k];
                        const double* from = &row[(across.first + k) * size];
                        double* to = &out[at * size];
                        for (std::size_t i = 0; i < size; ++i) to[i] += share * from[i];
                    }
                }
            }
        });
        ++below.next;
        const std::size_t needed = boxOf(below.next, below.height).first;
        for (; below.first < needed && !below.held.empty(); ++below.first) below.held.pop_front();
        emit(level + 1, std::move(out));
    }
}

void MipFilter::Work::emit(std::size_t level, std::vector<double> row) {
    Level& of = levels[level];
    const std::size_t y = of.first + of.held.size();
    if (y < of.own.last) sink({static_cast<int>(level), y, of.width, row});
    if (level + 1 >= levels.size()) {
        ++of.first;
        return;
    }
    of.held.push_back(std::move(row));
    reduce(level);
}

MipFilter::MipFilter(std::size_t width, std::size_t height, std::shared_ptr<const LobeTable> table,
                     const MipLayout& layout, Sink sink)
    : MipFilter(width, MipParts(width, height).part(0), std::move(table), layout, std::move(sink)) {
}

MipFilter::MipFilter(std::size_t width, const MipPart& part, std::shared_ptr<const LobeTable> table,
                     const MipLayout& layout, Sink sink)
    : work_(std::make_unique<Work>()) {
    if (width == 0 || part.height == 0) {
        throw UsageError(
            fmt::format("a surface of {} x {} texels has no levels", width, part.height));
    }
    layout.check(table->order());
    work_->width = width;
    work_->height = part.height;
    work_->table = std::move(table);
    work_->layout = layout;
    work_->sink = std::move(sink);
    work_->basis = bases::makeSh(std::max(3, layout.order), {});
    if (!work_->table->isotropic())
        work_->rotation = std::make_unique<ShRotation>(std::max(3, layout.order));
    work_->received = work_->firstHeld = part.needed(0).first;
    work_->last = part.needed(0).last;
    for (int level = 0; level <= part.level; ++level) {
        const MipRows above = level < part.level ? part.needed(level + 1) : MipRows{};
        work_->levels.push_back({.width = mipSize(width, level),
                                 .height = mipSize(part.height, level),
                                 .next = above.first,
                                 .end = above.last,
                                 .first = part.needed(level).first,
                                 .own = part.own(level)});
    }
}
MipFilter::~MipFilter() = default;
MipFilter::MipFilter(MipFilter&&) noexcept = default;
MipFilter& MipFilter::operator=(MipFilter&&) noexcept = default;

bool MipFilter::complete() const {
    return work_->received == work_->last;
}

void MipFilter::add(std::span<const SurfaceTexel> rows) {
    Work& w = *work_;
    const std::size_t count = rows.size() / w.width;
    if (rows.size() % w.width != 0)
        throw UsageError(fmt::format("{} texels are no whole rows of {}", rows.size(), w.width));
    if (count > w.last - w.received)
        throw InputError(
            fmt::format("{} rows of texels for a surface of {}", w.received + count, w.last));
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const std::string wrong = complaint(rows[k], w.layout, !w.table->isotropic());
        if (!wrong.empty())
            throw InputError(fmt::format("texel in row {}, column {}: {}", w.received + k / w.width,
                                         k % w.width, wrong));
    }
    for (std::size_t row = 0; row < count; ++row) {
        const auto from = rows.subspan(row * w.width, w.width);
        ++w.received;
        if (w.levels.size() == 1) continue;
        w.held.emplace_back(from.begin(), from.end());
        while (w.levels[0].next < w.levels[0].end) {
            const std::size_t y = w.levels[0].next;
            if (boxOf(y, w.height).end() > w.firstHeld + w.held.size()) break;
            std::vector<double> made = w.firstRow(y);
            ++w.levels[0].next;
            const std::size_t needed = boxOf(y + 1, w.height).first;
            for (; w.firstHeld < needed && !w.held.empty(); ++w.firstHeld) w.held.pop_front();
            w.emit(1, std::move(made));
        }
    }
}

void MipFilter::addRow(int level, std::vector<double> row) {
    const auto at = static_cast<std::size_t>(level);
    if (at + 1 >= work_->levels.size()) return;
    work_->levels[at].held.push_back(std::move(row));
    work_->reduce(at);
}

std::vector<double> ellipseNumbers(std::span<const SurfaceTexel> texels, const LobeTable& table,
                                   const MipLayout& layout) {
    const auto basis = bases::makeSh(3, {});
    const std::size_t size = layout.ellipseSize();
    std::vector<double> out(texels.size() * size, 0.0);
    eachInParallel((texels.size() + blockTexels - 1) / blockTexels, [&](std::size_t block) {
        const std::size_t end = std::min(texels.size(), (block + 1) * blockTexels);
        for (std::size_t k = block * blockTexels; k < end; ++k) {
            const SurfaceTexel& t = texels[k];
            const SurfaceFrame frame(t.normal, t.tangent);
            double y[9];
            basis->evaluate(frame.z, y);
            addMoments(t, frame.z, frame, table.widths(t.lobe), layout, y, 1, &out[k * size]);
        }
    });
    return out;
}

std::vector<MipLevel> filterNormals(std::size_t width, std::size_t height,
                                    std::span<const SurfaceTexel> base,
                                    std::shared_ptr<const LobeTable> table,
                                    const MipLayout& layout) {
    std::vector<MipLevel> levels;
    for (int level = 1; level <= mipLevels(width, height); ++level)
        levels.push_back({mipSize(width, level), mipSize(height, level), layout, {}});
    MipFilter filter(width, height, std::move(table), layout, [&](const MipRow& row) {
        std::vector<double>& texels = levels[static_cast<std::size_t>(row.level - 1)].texels;
        texels.insert(texels.end(), row.texels.begin(), row.texels.end());
    });
    filter.add(base);
    if (!filter.complete())
        throw InputError(
            fmt::format("{} texels for a surface of {} x {}", base.size(), width, height));
    return levels;
}

}  // namespace hshfit::inline normal_filtering
