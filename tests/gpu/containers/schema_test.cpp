// Every sidecar and test file, beside the files and within them, is what docs/schemas says.

#include "container_samples.h"
#include "places.h"

#include <cstdlib>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <nlohmann/json.hpp>

namespace hshfit::gpu {
namespace {

using samples::contentOf;
using samples::Folder;

int validate(const std::string& schema, const std::string& files) {
    const int status = std::system(fmt::format("/usr/bin/python3 '{0}/tests/validate_schema.py' "
                                               "'{0}/docs/schemas/{1}.schema.json' {2}",
                                               test::sourceFolder(), schema, files)
                                       .c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(GpuSchema, HoldsForEverySidecar) {
    const int code = validate("gpu", "/dev/null >/dev/null");
    if (code == 77 || code == 127) {
        GTEST_SKIP() << "no /usr/bin/python3 with jsonschema (package python3-jsonschema)";
    }
    const Folder folder;
    std::string sidecars, tests;
    for (const Number number : test::numbers) {
        for (const test::Sample& sample : test::samplePayloads(number)) {
            const std::string name = fmt::format("s{}", sidecars.size());
            test::exportTo(folder.path(), sample.payload, {},
                           {.fitError = R"({"metric":"rms","total":0.1})"}, name);
            sidecars += fmt::format(" '{}.hsh.json'", folder / name);
            tests += fmt::format(" '{}_test.json'", folder / name);
            for (const char* container : {"ktx2", "tensor", "js", "h"}) {
                const Container& row = findContainer(container);
                const std::string file = folder / row.fileName(name, Role::coefficients, number);
                samples::put(file + ".json", row.sidecar(contentOf(file), file));
                sidecars += fmt::format(" '{}.json'", file);
            }
        }
    }
    EXPECT_EQ(validate("gpu", sidecars), 0);
    EXPECT_EQ(validate("gpu_test", tests), 0);
}

TEST(GpuSchema, RefusesWhatLacksAKey) {
    if (validate("gpu", "/dev/null >/dev/null") != 1) GTEST_SKIP() << "no python3-jsonschema";
    const Folder folder;
    const test::Sample sample = test::samplePayloads(Number::float16)[0];
    test::exportTo(folder.path(), sample.payload, {"bin"});
    const auto good = nlohmann::json::parse(contentOf(folder / "sample.hsh.json"));
    std::string bad;
    std::size_t count = 0;
    for (const auto& [key, value] : good.items()) {
        auto without = good;
        without.erase(key);
        const std::string path = folder / fmt::format("without-{}.json", key);
        samples::put(path, without.dump());
        bad += fmt::format(" '{}'", path);
        ++count;
    }
    // one line of complaint for each
    const std::string lines = folder / "lines";
    EXPECT_EQ(validate("gpu", bad + " >'" + lines + "'"), 1);
    const std::string text = contentOf(lines);
    EXPECT_EQ(static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')), count);
}

}  // namespace
}  // namespace hshfit::gpu
