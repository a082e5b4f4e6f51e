// Evaluations leave the upper halves of vector registers clear, as calling conventions ask for on
// x86: scalar code that follows waits for their old contents otherwise, at a fifth of its speed.

#include <brdfs/measured_files.h>
#include <brdfs/models_grid.h>

#include <brdfs/measured/merl_writer.h>

#include <gtest/gtest.h>

namespace hshfit::brdfs {
namespace {

// Builds for debugging and with sanitizers inline nothing, and are slow anyhow.
#if defined(__x86_64__) && defined(NDEBUG) && !defined(__clang__)

/// Upper halves of registers that are not clear (XINUSE: AVX, and AVX-512's upper halves); not of
/// registers 16 to 31, which scalar code does not use.
[[gnu::target("xsave")]] unsigned long long upperHalves() {
    return __builtin_ia32_xgetbv(1) & 0x44;
}
[[gnu::target("avx")]] void clear() {
    __builtin_ia32_vzeroupper();
}

bool canTell() {
    __builtin_cpu_init();
    unsigned leaf = 0xd, part = 1;
    unsigned b, d;
    __asm__("cpuid" : "+a"(leaf), "=b"(b), "+c"(part), "=d"(d));
    return __builtin_cpu_supports("avx") && (leaf & 4) != 0;
}

void check(const std::string& spec) {
    const auto brdf = open(spec);
    for (const std::size_t count : {3, 8, 19, 64}) {
        std::vector<double> x(count), y(count), z(count);
        std::vector<double> out(count * brdf->channels().count());
        for (std::size_t k = 0; k < count; ++k) {
            const Direction d = directionFromAngles(
                1.4 * (static_cast<double>(k) + 0.5) / static_cast<double>(count),
                static_cast<double>(k));
            x[k] = d.x, y[k] = d.y, z[k] = d.z;
        }
        clear();
        brdf->eval(directionFromAngles(0.5, 0.1), {x.data(), y.data(), z.data(), count},
                   out.data());
        const unsigned long long after = upperHalves();
        clear();
        EXPECT_EQ(after, 0u) << spec << ", " << count << " directions";
    }
}

TEST(VectorRegisters, AreClearAfterEveryModel) {
    if (!canTell()) GTEST_SKIP() << "the processor does not tell which registers are in use";
    for (const Case& row : modelGrid()) check(row.spec);
}

TEST(VectorRegisters, AreClearAfterMeasuredTables) {
    if (!canTell()) GTEST_SKIP() << "the processor does not tell which registers are in use";
    const test::TemporaryFile file("table", ".binary");
    writeMerl(*open("lambert:kd=.2+ggx:alpha=.3"), file.path(), {.force = true});
    check(file.path());
    check(file.path() + ":interpolation=nearest");
}

#endif

}  // namespace
}  // namespace hshfit::brdfs
