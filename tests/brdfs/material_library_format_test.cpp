// LIBRARY:NAME against a library made by hand, whose materials are constants.

#include <brdfs/catalog.h>
#include <hshfit/error.h>
#include <hshfit/material_library/library_file.h>
#include <hshfit/material_library/log_terms.h>
#include <temporary_file.h>

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace hshfit::brdfs {
namespace {

namespace ml = material_library;

/// A material of f = `value` everywhere: its sum of terms is far above its bound.
ml::Material constant(const std::string& name, double value) {
    ml::LogMaterial material{std::vector<double>(ml::logTerms().size(), 0.0),
                             {std::log(value + ml::logOffset)}};
    std::vector<double> terms(ml::logTerms().size());
    ml::logTerms().evaluate({0, 0, 1}, {0, 0, 1}, terms.data());
    for (std::size_t t = 0; t < terms.size(); ++t)
        if (terms[t] == 1) material.exponents[t] = 30;
    ml::Material one{.name = name, .source = "made", .kind = ml::Kind::polynomial};
    one.channels = 1;
    one.polynomial = material;
    one.bytes = 1;
    return one;
}

class MaterialLibraryFormat : public testing::Test {
protected:
    MaterialLibraryFormat() {
        ml::Library library;
        library.materials = {constant("kd=.1_ggx", 0.1), constant("matte", 0.25)};
        AtomicFile file(file_.path());
        ml::writeLibrary(library, file);
        file.commit();
    }
    double at(const std::string& name) const {
        return evaluate(*open(file_.path() + name), {0, 0, 1}, {0, 0, 1})[0];
    }
    std::string refusal(const std::string& name) const {
        try {
            open(file_.path() + name);
        } catch (const UsageError& error) {
            return error.what();
        }
        return {};
    }
    test::TemporaryFile file_{""};
};

TEST_F(MaterialLibraryFormat, AMaterialIsFoundByItsName) {
    EXPECT_NEAR(at(":matte"), 0.25, 1e-6);
    EXPECT_NEAR(at(":kd=.1_ggx"), 0.1, 1e-6);
    EXPECT_EQ(open(file_.path() + ":matte")->name(), file_.path() + ":matte");
}

TEST_F(MaterialLibraryFormat, NamesThatAreNotThereAndNoneAreRefused) {
    EXPECT_NE(refusal(":mate").find("did you mean matte?"), std::string::npos) << refusal(":mate");
    EXPECT_NE(refusal("").find("name one of them"), std::string::npos) << refusal("");
}

}  // namespace
}  // namespace hshfit::brdfs
