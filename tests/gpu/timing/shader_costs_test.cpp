#include <hshfit/error.h>
#include <hshfit/gpu/timing/shader_costs.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <string>

namespace hshfit {
namespace {

/// Mesa's compiler for AMD, or a skip.
class ShaderCostsOfAmd : public testing::Test {
protected:
    void SetUp() override {
        try {
            costs_ = std::make_unique<gpu::ShaderCosts>();
        } catch (const NumericError& error) {
            const std::string reason = error.what();
            const bool missing = reason.find("mesa-vulkan-drivers") != reason.npos ||
                                 reason.find("built without Vulkan") != reason.npos;
            ASSERT_TRUE(missing) << reason;
            GTEST_SKIP() << reason;
        }
    }
    const gpu::ShaderCosts& costs() const { return *costs_; }

    /// The cost of a chain of one operation on a number from a buffer.
    gpu::ShaderCost chain(const char* operation, int times) const {
        std::string body;
        for (int k = 0; k < times; ++k) body += fmt::format("    x = {};\n", operation);
        return costs().of(
            {.source = fmt::format("#version 450\nlayout(local_size_x = 64) in;\n"
                                   "layout(std430, binding = 3) buffer X {{ float all[]; }};\n"
                                   "void main() {{\n    float x = all[gl_GlobalInvocationID.x], "
                                   "y = all[0];\n{}    all[gl_GlobalInvocationID.x] = x;\n}}\n",
                                   body),
             .resources = {{.binding = gpu::sumsBinding}}});
    }

private:
    std::unique_ptr<gpu::ShaderCosts> costs_;
};

/// By AMD's documents of RDNA 2, a vector unit has 32 lanes, and a quarter of that rate for
/// transcendental functions: a wave of 64 threads takes 2 cycles for a multiplication with addition
/// and 8 for an exponential.
TEST_F(ShaderCostsOfAmd, CyclesAreThoseOfTheVectorUnit) {
    const gpu::ShaderCost few = chain("x * y + x", 100), many = chain("x * y + x", 300);
    EXPECT_EQ(many.instructions - few.instructions, 200U);
    EXPECT_EQ(many.cycles - few.cycles, 400U);
    const gpu::ShaderCost some = chain("exp2(x)", 100), more = chain("exp2(x)", 300);
    EXPECT_NEAR(static_cast<double>(more.cycles - some.cycles), 1600, 16);
    EXPECT_EQ(more.spilled, 0U);
}

TEST_F(ShaderCostsOfAmd, FormsOfMoreTermsCostMore) {
    std::uint64_t last = 0;
    for (const int lobes : {0, 1, 2, 4}) {
        const std::uint64_t now = costs().of(gpu::lobesShader(lobes)).cycles;
        EXPECT_GT(now, last);
        last = now;
    }
    EXPECT_EQ(costs().ggx().cycles, costs().of(gpu::lobesShader(1)).cycles);
}

TEST_F(ShaderCostsOfAmd, TheEnvironmentIsAsItWas) {
    EXPECT_EQ(std::getenv("RADV_FORCE_FAMILY"), nullptr);
    EXPECT_EQ(costs().device(), "NAVI21");
}

TEST_F(ShaderCostsOfAmd, AShaderThatIsNoneIsNamed) {
    EXPECT_THROW(costs().of({.source = "#version 450\nvoid main() { x; }\n"}), NumericError);
}

}  // namespace
}  // namespace hshfit
