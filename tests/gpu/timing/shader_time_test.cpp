#include "../forms/form_samples.h"

#include <hshfit/error.h>
#include <hshfit/gpu/timing/shader_time.h>
#include <hshfit/gpu/vulkan/spirv.h>
#include <hshfit/projection/projection.h>
#include <hshfit/representation/forms/represented_brdf.h>

#include <brdfs/catalog.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

namespace hshfit {
namespace {

constexpr std::uint32_t groups = gpu::timedSide * gpu::timedSide / 64;

/// The software renderer, or a skip.
class TimedShaders : public testing::Test {
protected:
    void SetUp() override {
        try {
            device_ = std::make_unique<gpu::ComputeDevice>(gpu::DeviceChoice{
                .kind = gpu::DeviceChoice::Kind::software, .name = {}, .validate = true});
        } catch (const NumericError& error) {
            GTEST_SKIP() << error.what();
        }
    }
    std::vector<float> sumsOf(const gpu::TimedShader& shader) const {
        gpu::ComputeProgram program(*device_, gpu::compileGlsl(shader.source), shader.resources);
        EXPECT_GT(program.run(groups), 0);
        return program.read(gpu::sumsBinding);
    }
    const gpu::ComputeDevice& device() const { return *device_; }
    void TearDown() override {
        if (!device_) return;
        for (const std::string& message : device_->messages()) ADD_FAILURE() << message;
    }

private:
    std::unique_ptr<gpu::ComputeDevice> device_;
};

/// The sphere's local frame at a pixel, from the definition in the header: its normal is n, its
/// tangent horizontal.
DirectionPair pairAt(int row, int column) {
    const double x = 1.4 * (column + 0.5) / gpu::timedSide - 0.7;
    const double y = 1.4 * (row + 0.5) / gpu::timedSide - 0.7;
    const double z = std::sqrt(1 - x * x - y * y), r = std::hypot(x, z);
    const auto local = [&](double a, double b, double c) {
        return Direction{(a * z - c * x) / r, (-a * x * y + b * r * r - c * y * z) / r,
                         a * x + b * y + c * z};
    };
    return {local(0.36, 0.48, 0.8), local(0, 0, 1)};
}

void expectSums(const Brdf& brdf, const std::vector<float>& sums) {
    const std::size_t channels = brdf.channels().count();
    std::vector<double> values(channels);
    for (int row = 3; row < gpu::timedSide; row += 97) {
        for (int column = 5; column < gpu::timedSide; column += 89) {
            const auto [wi, wo] = pairAt(row, column);
            double expected = 0;
            if (wi.z > 0) {
                brdf.eval(wo, {&wi.x, &wi.y, &wi.z, 1}, values.data());
                for (const double value : values) expected += std::max(value, 0.0);
            }
            const auto at = static_cast<std::size_t>(row * gpu::timedSide + column);
            ASSERT_NEAR(sums[at], expected, 2e-4 * (1 + std::abs(expected)))
                << brdf.name() << ", row " << row << ", column " << column;
        }
    }
}

std::unique_ptr<Brdf> nothingToOpen(const std::string& spec) {
    throw std::runtime_error("opens " + spec);
}

/// The formula that forms stand beside is the model's.
TEST_F(TimedShaders, LobesAreLambertAndGgx) {
    const auto brdf = brdfs::open(
        fmt::format("lambert:kd={}/{}/{} + ggx:alpha={},F0=.5/.6/.3 + ggx:alpha=.2,F0=.3333/.6/.3",
                    0.1 * pi, 0.05 * pi, 0.02 * pi, std::sqrt(0.08)));
    expectSums(*brdf, sumsOf(gpu::lobesShader(2)));
}

/// The cosine between the view and the light is 0.8 in every frame.
TEST_F(TimedShaders, MakeTheDirectionsOfASphere) {
    for (const float sum : sumsOf(gpu::bareShader())) ASSERT_NEAR(sum, 0.8, 1e-6);
}

TEST_F(TimedShaders, EvaluateTheFormsThatTheyTime) {
    std::size_t tried = 0;
    for (const auto& list : {samples::halfwaySamples(), samples::basisSamples()}) {
        for (std::size_t k = 0; k < list.size(); k += 4) {
            const auto brdf = reconstruct(list[k].form, nothingToOpen);
            expectSums(*brdf, sumsOf(gpu::timedShader(list[k].form)));
            ++tried;
        }
    }
    EXPECT_GE(tried, 4u);
}

TEST_F(TimedShaders, RefuseAFormThatAddsABrdf) {
    Representation form = samples::halfwaySamples().front().form;
    form.added = "lambert";
    EXPECT_THROW(gpu::timedShader(form), UsageError);
}

/// One time for each shader, its quartiles in order.
TEST_F(TimedShaders, TakeTurns) {
    const std::vector<gpu::TimedShader> shaders{
        gpu::bareShader(), gpu::timedShader(samples::halfwaySamples().back().form)};
    int done = 0;
    const auto times = gpu::timeShaders(device(), shaders, {.repeats = 3, .done = [&] { ++done; }});
    ASSERT_EQ(times.size(), 2u);
    EXPECT_EQ(done, 2);
    for (const gpu::ShaderTime& time : times) {
        EXPECT_GT(time.low, 0);
        EXPECT_LE(time.low, time.median);
        EXPECT_LE(time.median, time.high);
    }
}

TEST_F(TimedShaders, ReadWhatIsWrittenBetweenRuns) {
    gpu::ComputeProgram program(
        device(),
        gpu::compileGlsl("#version 450\nlayout(local_size_x = 4) in;\n"
                         "layout(std430, binding = 0) readonly buffer In { float from[]; };\n"
                         "layout(std430, binding = 1) writeonly buffer Out { float to[]; };\n"
                         "void main() { uint k = gl_LocalInvocationID.x; "
                         "to[k] = 2.0 * from[k]; }\n"),
        {{.binding = 0, .numbers = {1, 2, 3, 4}}, {.binding = 1, .count = 4}});
    program.run(1);
    EXPECT_EQ(program.read(1), (std::vector<float>{2, 4, 6, 8}));
    program.write(0, std::vector<float>{5, 6});
    program.run(1);
    EXPECT_EQ(program.read(1), (std::vector<float>{10, 12, 6, 8}));
    EXPECT_THROW(program.write(0, std::vector<float>(5)), UsageError);
    EXPECT_THROW(program.write(2, std::vector<float>(1)), UsageError);
}

TEST(ComputeDevice, NamesTheDevicesThatThereAre) {
    try {
        const gpu::ComputeDevice device({.name = "no such device"});
        FAIL() << "found " << device.name();
    } catch (const NumericError& error) {
        const std::string text = error.what();
        EXPECT_TRUE(text.find("found: ") != std::string::npos ||
                    text.find("there is no Vulkan here") != std::string::npos ||
                    text.find("built without Vulkan") != std::string::npos)
            << text;
    }
}

TEST(CompileGlsl, RefusesWhatDoesNotCompileInOneLine) {
    try {
        gpu::compileGlsl("#version 450\nvoid main() { undeclared = 1; }\n");
        FAIL();
    } catch (const NumericError& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
}

}  // namespace
}  // namespace hshfit
