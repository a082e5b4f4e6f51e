// ALTA text that is written reads back, by our reader and by what the format says.

#include <brdfs/catalog.h>
#include <brdfs/measured/scattered/alta_writer.h>
#include <brdfs/measured/scattered/scattered.h>
#include <brdfs/measured_files.h>
#include <brdfs/rows/spec.h>

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

namespace hshfit::brdfs {
namespace {

std::vector<std::string> write(const Brdf& brdf, const std::string& path,
                               const std::string& options) {
    const Writer& writer = altaWriter();
    return writer.write(brdf, path, parseParameters(writer.name, writer.parameters, options),
                        {.force = true});
}

// Each line's numbers, read by iostreams, give the BRDF's own value at their directions.
TEST(AltaWriter, everyRowHoldsTheValueAtItsDirections) {
    for (const char* spec : {"ggx:alpha=.5,F0=.2/.5/.9", "ward:kd=.2,ks=.3,ax=.2,ay=.5"}) {
        const auto brdf = openModel(spec);
        const test::TemporaryFile file("", ".alta");
        const auto notes = write(*brdf, file.path(), "theta=5,phi=8,last=80");
        EXPECT_EQ(notes.size(), 1u);
        std::ifstream in(file.path());
        std::string line;
        std::size_t rows = 0;
        while (std::getline(in, line)) {
            if (line.starts_with("#")) continue;
            std::istringstream numbers(line);
            std::vector<double> row;
            for (double x; numbers >> x;) row.push_back(x);
            ++rows;
            Direction wi, wo;
            if (brdf->laws().isotropic) {
                ASSERT_EQ(row.size(), 6u);
                wi = directionFromAngles(row[0], 0);
                wo = directionFromAngles(std::hypot(row[1], row[2]), std::atan2(row[2], row[1]));
                row.erase(row.begin(), row.begin() + 3);
            } else {
                ASSERT_EQ(row.size(), 5u);
                wi = directionFromAngles(row[0], row[1]);
                wo = directionFromAngles(row[2], row[3]);
                row.erase(row.begin(), row.begin() + 4);
            }
            const auto expected = evaluate(*brdf, wi, wo);
            for (std::size_t c = 0; c < expected.size(); ++c) {
                EXPECT_NEAR(row[c], expected[c], 1e-9 * (1 + expected[c]));
            }
        }
        // 5 incidences of 1 + 4 x 5 views (half the circle); or 5 x 8 of 1 + 4 x 8.
        EXPECT_EQ(rows, brdf->laws().isotropic ? 5u * 21 : 40u * 33);
    }
}

TEST(AltaWriter, readsBackTheSameAtItsNodes) {
    const auto brdf = openModel("ggx:alpha=.5,F0=.2/.5/.9");
    const test::TemporaryFile file("", ".alta");
    write(*brdf, file.path(), "theta=9,phi=12,last=80");
    const auto back = open(file.path());
    EXPECT_TRUE(back->laws().isotropic);
    EXPECT_TRUE(back->laws().mirrorSymmetric);
    for (double ti = 0; ti <= 80; ti += 10) {
        for (double to = 0; to <= 80; to += 10) {
            for (double phi = 0; phi < 360; phi += 30) {
                const Direction i = directionFromAngles(radians(ti), 1);
                const Direction o = directionFromAngles(radians(to), 1 + radians(phi));
                const auto expected = evaluate(*brdf, i, o), got = evaluate(*back, i, o);
                for (std::size_t c = 0; c < 3; ++c) {
                    EXPECT_NEAR(got[c], expected[c], 1e-6 * (1 + expected[c]));
                }
            }
        }
    }
}

TEST(AltaWriter, scatteredSamplesAreKept) {
    const test::TemporaryFile first(
        "#DIM 4 1\n#PARAM_IN SPHERICAL_TL_PL_TV_PV\n"
        "0.1 0.2 0.3 0.4 5\n0.5 2.2 0.7 -0.4 0.125\n0.5 1 0.7 3 1e-3\n",
        ".alta");
    const test::TemporaryFile second("", ".alta");
    const auto brdf = open(first.path());
    write(*brdf, second.path(), "");
    const auto back = open(second.path());
    const auto& a = dynamic_cast<const Scattered&>(*brdf).samples();
    const auto& b = dynamic_cast<const Scattered&>(*back).samples();
    ASSERT_EQ(a.size(), b.size());
    EXPECT_EQ(a.values, b.values);
    for (std::size_t k = 0; k < a.size(); ++k) {
        EXPECT_NEAR(dot(a.wi[k], b.wi[k]), 1, 1e-15);
        EXPECT_NEAR(dot(a.wo[k], b.wo[k]), 1, 1e-15);
    }
}

TEST(AltaWriter, refusesWhatTheFormatCannotHold) {
    const test::TemporaryFile file("", ".alta");
    const test::TemporaryFile spectral("1\n400\n0.1 0 0.2 0 1\n", ".brdf");
    EXPECT_THROW(write(*open(spectral.path()), file.path(), ""), UsageError);
    EXPECT_THROW(write(*openModel("lambert"), file.path(), "grid=samples"), UsageError);
    EXPECT_THROW(
        altaWriter().write(*openModel("lambert"), file.path(),
                           parseParameters("alta", altaWriter().parameters, ""), {.force = false}),
        OutputError);
}

}  // namespace
}  // namespace hshfit::brdfs
