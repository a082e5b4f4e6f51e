// Parts of a surface, as processes share them: the same bits as of the whole.

#include <lib/normal_filtering/surfaces.h>

#include <hshfit/normal_filtering/gathered_texels.h>

#include <gtest/gtest.h>

#include <map>

namespace {

using namespace hshfit;

struct Size {
    std::size_t width, height;
};
using Rows = std::map<std::pair<int, std::size_t>, std::vector<double>>;

constexpr MipLayout layout{.weights = 1, .albedos = 1, .order = 5};

std::vector<SurfaceTexel> texelsOf(const Size& size) {
    const test::SlopeMap map = test::SlopeMap::bumpy(0.3);
    std::vector<SurfaceTexel> texels(size.width * size.height);
    for (std::size_t k = 0; k < texels.size(); ++k) {
        const auto x = static_cast<double>(k % size.width), y = static_cast<double>(k / size.width);
        texels[k].normal = map.normal(x, y);
        texels[k].weights[0] = 1 + std::sin(x * y);
        texels[k].albedos[0] = 0.3;
    }
    return texels;
}

std::span<const SurfaceTexel> rowOf(const std::vector<SurfaceTexel>& texels, const Size& size,
                                    std::size_t y) {
    return std::span(texels).subspan(y * size.width, size.width);
}

/// Rows of all levels, each filtered in its part, the last part first.
Rows filtered(const Size& size, const std::vector<SurfaceTexel>& texels, const MipParts& parts) {
    const auto table = test::ggxTable(5, 0.2, 0.2);
    Rows rows;
    const auto sink = [&](const MipRow& row) {
        const bool isNew =
            rows.try_emplace({row.level, row.y}, row.texels.begin(), row.texels.end()).second;
        EXPECT_TRUE(isNew) << row.level << ' ' << row.y;
    };
    for (std::size_t k = parts.count(); k-- > 0;) {
        const MipPart part = parts.part(k);
        MipFilter filter(size.width, part, table, layout, sink);
        for (std::size_t y = part.needed(0).first; y < part.needed(0).last; ++y)
            filter.add(rowOf(texels, size, y));
        EXPECT_TRUE(filter.complete());
    }
    MipFilter above(size.width, size.height, table, layout, sink);
    const int last = parts.level();
    for (std::size_t y = 0; y < mipSize(size.height, last); ++y)
        above.addRow(last, rows.at({last, y}));
    return rows;
}

TEST(MipParts, FilterTheBitsOfTheWhole) {
    for (const Size& size : {Size{64, 64}, Size{300, 21}, Size{50, 37}, Size{17, 130}, Size{9, 100},
                             Size{128, 4}, Size{3, 255}, Size{5, 1}}) {
        const std::vector<SurfaceTexel> texels = texelsOf(size);
        const Rows whole = filtered(size, texels, {size.width, size.height});
        std::size_t most = 1;
        for (const std::size_t held : {1 << 20, 4000, 500}) {
            for (const std::size_t parts : {2, 5, 100}) {
                const MipParts several(size.width, size.height, parts, layout.size(), held, 2);
                EXPECT_LE(several.count(), parts);
                EXPECT_EQ(filtered(size, texels, several), whole)
                    << size.width << " x " << size.height << ": " << several.count() << " parts";
                most = std::max(most, several.count());
            }
        }
        EXPECT_TRUE(most > 1 || size.height < 32) << size.height;
    }
}

TEST(MipParts, HoldNoMoreNumbersOfTheirLastLevelThanAskedFor) {
    for (const std::size_t held : {100000, 10000, 1000}) {
        const MipParts parts(1000, 1000, 16, 20, held, 16);
        ASSERT_GT(parts.count(), 1);
        EXPECT_LE((1000 >> parts.level()) * (1000 >> parts.level()) * 20, held);
        std::size_t next = 0;
        for (std::size_t k = 0; k < parts.count(); ++k) {
            const MipRows own = parts.part(k).own(0), needed = parts.part(k).needed(0);
            EXPECT_EQ(own.first, next);
            EXPECT_EQ(own.first % 16, 0);
            EXPECT_LE(4 * (needed.last - own.last), own.last - own.first);
            next = own.last;
        }
        EXPECT_EQ(next, 1000);
    }
}

TEST(GatheredTexels, OfPartsAreThoseOfTheWhole) {
    const Size size{50, 150};
    const std::vector<SurfaceTexel> texels = texelsOf(size);
    const std::vector<MipPlace> places{{1, 700}, {3, 20}, {6, 1}, {7, 0}};
    const auto empty = [&] { return GatheredTexels(size.width, size.height, places, 64); };
    GatheredTexels whole = empty(), all = empty();
    for (std::size_t y = 0; y < size.height; ++y) whole.add(y, rowOf(texels, size, y));
    whole.finish();
    for (const MipRows& rows : {MipRows{96, 150}, MipRows{0, 32}, MipRows{32, 96}}) {
        GatheredTexels part = empty();
        for (std::size_t y = rows.first; y < rows.last; ++y) part.add(y, rowOf(texels, size, y));
        const std::vector<SurfaceTexel> taken = part.taken(rows);
        EXPECT_EQ(taken.size(), all.takenCount(rows));
        all.put(rows, taken);
    }
    all.finish();
    for (std::size_t k = 0; k < places.size(); ++k) {
        const SurfaceTexel &a = whole.texel(k).mean, &b = all.texel(k).mean;
        EXPECT_EQ(a.normal.x, b.normal.x);
        EXPECT_EQ(a.weights, b.weights);
        ASSERT_EQ(whole.texel(k).base.size(), all.texel(k).base.size());
        for (std::size_t s = 0; s < whole.texel(k).base.size(); ++s)
            EXPECT_EQ(whole.texel(k).base[s].normal.y, all.texel(k).base[s].normal.y);
    }
    // The mean of the last texel is the mean of all texels.
    double mean = 0;
    for (const SurfaceTexel& texel : texels) mean += texel.weights[0];
    EXPECT_NEAR(all.texel(3).mean.weights[0], mean / static_cast<double>(texels.size()), 1e-12);
}

/// Each process measures its share, and gets the records of the others.
TEST(MipErrors, OfSharesAreThoseOfAllTexels) {
    const test::GgxSurface ggx(test::SlopeMap::bumpy(0.3), 0.2, 0.2, 16);
    const auto table = ggx.table(5);
    const MipLevel level = filterNormals(16, 16, ggx.texels, table, layout)[1];
    const auto texel = [&](std::size_t k, std::mt19937_64&) {
        MeasuredTexel measured{.base = {ggx.texels.begin(), ggx.texels.begin() + 4}};
        measured.mean = ggx.texels[k];
        measured.numbers.assign(level.texel(k, 0).begin(), level.texel(k, 0).end());
        return measured;
    };
    const auto errors = [&](const MipErrorShare& share) {
        return measureMipTexels(ggx.surface(), layout, 4, texel, *table, {}, share);
    };
    const MipErrors whole = errors({});
    std::vector<double> first;
    errors({0, 1, [&](std::vector<double>& records) { first = records; }});
    const MipErrors shared = errors({1, 4, [&](std::vector<double>& records) {
                                         const auto own =
                                             static_cast<std::ptrdiff_t>(records.size() / 4);
                                         std::copy_n(first.begin(), own, records.begin());
                                     }});
    ASSERT_EQ(shared.forms.size(), whole.forms.size());
    for (std::size_t f = 0; f < whole.forms.size(); ++f) {
        EXPECT_EQ(shared.forms[f].relative, whole.forms[f].relative);
        EXPECT_EQ(shared.forms[f].maximum, whole.forms[f].maximum);
        EXPECT_EQ(shared.forms[f].wi.x, whole.forms[f].wi.x);
        EXPECT_EQ(shared.forms[f].albedo, whole.forms[f].albedo);
        EXPECT_EQ(shared.forms[f].texels, whole.forms[f].texels);
        EXPECT_GT(whole.forms[f].relative, 0);
    }
}

}  // namespace
