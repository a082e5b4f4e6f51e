// Texts of the target three. Pictures: browser/three_module.mjs; types: three_package.mjs.
#include "asymmetric.h"

#include <hshfit/error.h>
#include <hshfit/gpu/highlight.h>
#include <hshfit/gpu/three/three_files.h>

#include <brdfs/catalog.h>

#include <gtest/gtest.h>

#include <map>
#include <set>

namespace hshfit::gpu {
namespace {

Payload payloadOf(const Channels& channels, const PackOptions& options = {}) {
    return pack(samples::asymmetric("hsh", 3, OutgoingSet::parabolic(8, 8), channels, 1), options);
}

std::map<std::string, std::string> filesOf(const Payload& payload, const ThreeOptions& options) {
    std::map<std::string, std::string> files;
    for (const TextFile& file : threeFiles(payload, options)) files[file.path] = file.text;
    return files;
}

TEST(Three, NamesAreThoseOfTheMaterialAndEndNothingEarly) {
    Payload payload = payloadOf(Channels::rgb());
    payload.head.source = "/somewhere/secret/a*/`${x}</script>\u2028b.bsdf";
    for (const auto& [path, text] : filesOf(payload, {.name = "paint"})) {
        EXPECT_EQ(text.find("secret"), text.npos) << path;
        EXPECT_EQ(text.find("${x}"), text.npos) << path << ": a template literal is left";
        EXPECT_EQ(text.find("\u2028"), text.npos) << path << ": a line separator is left";
        EXPECT_EQ(text.find("{{"), text.npos) << path << ": a word is not filled in";
    }
    const std::string page = filesOf(payload, {.name = "paint"})["paint_three.html"];
    EXPECT_EQ(page.find("x}</script>"), page.npos) << "the title is not escaped";
}

TEST(Three, FilesNameOneAnother) {
    const auto files = filesOf(payloadOf(Channels::grey()), {.name = "a.b-c"});
    std::set<std::string> paths;
    for (const auto& [path, text] : files) paths.insert(path);
    EXPECT_EQ(paths,
              (std::set<std::string>{"a.b-c_three.js", "a.b-c_three.d.ts", "a.b-c_three_webgpu.js",
                                     "a.b-c_three_webgpu.d.ts", "a.b-c_three_data.js",
                                     "a.b-c_three.html", "package.json"}));
    for (const char* path : {"a.b-c_three.js", "a.b-c_three_webgpu.js"})
        EXPECT_NE(files.at(path).find("from './a.b-c_three_data.js'"), std::string::npos) << path;
    EXPECT_NE(files.at("package.json").find("\"hshfit-a-b-c\""), std::string::npos);
}

TEST(Three, RefusesWhatAMaterialCannotBe) {
    const Payload grey = payloadOf(Channels::grey());
    EXPECT_THROW(threeFiles(payloadOf(Channels::spectral({450, 550, 650})), {.name = "a"}),
                 UsageError);
    EXPECT_EQ(filesOf(payloadOf(Channels::grey(), {.basisSize = 16}), {.name = "a"}),
              filesOf(grey, {.name = "a"}));
    for (const char* name : {"", "a b", "../a", "a'b", "a\"", "a\n"})
        EXPECT_THROW(threeFiles(grey, {.name = name}), UsageError) << name;
    // A row of a texture for each material: devices need take no more than 2048.
    EXPECT_THROW(threeFiles(SharedSums{}, std::vector<std::string>(2049, "m"), {.name = "a"}),
                 UsageError);
}

TEST(Highlight, RoughnessOfGgxIsItsAlpha) {
    // A fit names no lobes: its highlight is measured. Fresnel and masking widen it a little.
    class Unnamed : public Brdf {
    public:
        explicit Unnamed(std::unique_ptr<Brdf> brdf) : brdf_(std::move(brdf)) {}
        std::string name() const override { return brdf_->name(); }
        const Channels& channels() const override { return brdf_->channels(); }
        const Laws& laws() const override { return brdf_->laws(); }
        void eval(const Direction& wo, DirectionBatch wi, double* out) const override {
            brdf_->eval(wo, wi, out);
        }

    private:
        std::unique_ptr<Brdf> brdf_;
    };
    for (const double alpha : {0.05, 0.1, 0.2, 0.4}) {
        const std::string spec = "ggx:alpha=" + std::to_string(alpha);
        const Unnamed brdf(brdfs::open(spec));
        EXPECT_NEAR(highlightRoughness(brdf), alpha, 0.15 * alpha) << spec;
    }
    EXPECT_EQ(highlightRoughness(Unnamed(brdfs::open("lambert"))), 1);
}

}  // namespace
}  // namespace hshfit::gpu
