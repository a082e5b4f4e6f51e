// Specifications, presets and what is said about those that are wrong.

#include <brdfs/catalog.h>
#include <brdfs/catalog/preset.h>
#include <brdfs/rows/spec.h>
#include <gtest/gtest.h>
#include <hshfit/error.h>

#include <filesystem>
#include <fstream>
#include <set>

namespace hshfit::brdfs {
namespace {

namespace fs = std::filesystem;

/// Opening `spec` throws an E of one line that contains every one of `parts`.
template <class E>
void expectError(const std::string& spec, const std::vector<std::string>& parts) {
    SCOPED_TRACE(spec);
    try {
        const auto brdf = open(spec);
        ADD_FAILURE() << "opened as " << brdf->name();
    } catch (const E& error) {
        const std::string message = error.what();
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        for (const std::string& part : parts)
            EXPECT_NE(message.find(part), std::string::npos) << message << "\nlacks: " << part;
    }
}

class Files : public testing::Test {
protected:
    void SetUp() override {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        folder_ = fs::path(testing::TempDir()) / (std::string("hshfit_spec_") + test->name());
        fs::remove_all(folder_);
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    std::string write(const std::string& name, const std::string& content) {
        const fs::path path = folder_ / name;
        fs::create_directories(path.parent_path());
        std::ofstream(path, std::ios::binary) << content;
        return path.string();
    }
    fs::path folder_;
};

TEST(Spec, CanonicalNameLeavesDefaultsOutAndKeepsEveryDigit) {
    EXPECT_EQ(open("lambert")->name(), "lambert");
    EXPECT_EQ(open("lambert:kd=1")->name(), "lambert");
    EXPECT_EQ(open("phong:exponent=37,ks=1,kd=0")->name(), "phong:exponent=37");
    EXPECT_EQ(open("ward:ay=.5,variant=1992,ax=0.20")->name(), "ward:ax=0.2,ay=0.5");
    EXPECT_EQ(open("phong:exponent=0.1234567890123456")->name(),
              "phong:exponent=0.1234567890123456");
    EXPECT_EQ(open("phong:exponent=5,kd=-0")->name(), "phong:exponent=5");
}

TEST(Spec, ColoursMakeRgbOnlyIfTheyDiffer) {
    EXPECT_EQ(open("lambert:kd=.2")->channels().kind, Channels::Kind::grey);
    EXPECT_EQ(open("lambert:kd=.2/.2/.2")->channels().kind, Channels::Kind::grey);
    EXPECT_EQ(open("lambert:kd=.2/.2/.2")->name(), "lambert:kd=0.2");
    const auto brdf = open("lambert:kd=.2/.4/.8");
    ASSERT_EQ(brdf->channels().kind, Channels::Kind::rgb);
    const std::vector<double> f = evaluate(*brdf, {0, 0, 1}, {0, 0, 1});
    EXPECT_DOUBLE_EQ(f[0], .2 / pi);
    EXPECT_DOUBLE_EQ(f[1], .4 / pi);
    EXPECT_DOUBLE_EQ(f[2], .8 / pi);
}

// Channels share their lobe: a colour equals three grey BRDFs.
TEST(Spec, RgbEqualsGreyPerChannel) {
    const std::vector<std::vector<std::string>> triples{
        {"ward:ax=.2,ay=.5,kd=.1/.2/.3,ks=.5", "ward:ax=.2,ay=.5,kd=.1,ks=.5",
         "ward:ax=.2,ay=.5,kd=.2,ks=.5", "ward:ax=.2,ay=.5,kd=.3,ks=.5"},
        {"ggx:alpha=.3,F0=1/.7/.3", "ggx:alpha=.3,F0=1", "ggx:alpha=.3,F0=.7",
         "ggx:alpha=.3,F0=.3"},
        {"cook-torrance:m=.3,F0=.9/.5/.1,ks=.7/.8/.9", "cook-torrance:m=.3,F0=.9,ks=.7",
         "cook-torrance:m=.3,F0=.5,ks=.8", "cook-torrance:m=.3,F0=.1,ks=.9"},
        {"ashikhmin-shirley:nu=9,nv=90,Rs=.9/.5/.1,Rd=.5/.2/.9",
         "ashikhmin-shirley:nu=9,nv=90,Rs=.9,Rd=.5", "ashikhmin-shirley:nu=9,nv=90,Rs=.5,Rd=.2",
         "ashikhmin-shirley:nu=9,nv=90,Rs=.1,Rd=.9"},
        {"oren-nayar:sigma=30,variant=full,kd=.9/.5/.1", "oren-nayar:sigma=30,variant=full,kd=.9",
         "oren-nayar:sigma=30,variant=full,kd=.5", "oren-nayar:sigma=30,variant=full,kd=.1"},
    };
    const Direction wi = directionFromAngles(.6, .2), wo = directionFromAngles(.5, 3);
    for (const auto& triple : triples) {
        const std::vector<double> f = evaluate(*open(triple[0]), wi, wo);
        ASSERT_EQ(f.size(), 3u);
        for (int c = 0; c < 3; ++c)
            EXPECT_DOUBLE_EQ(f[c], evaluate(*open(triple[c + 1]), wi, wo)[0]) << triple[c + 1];
    }
}

TEST(Spec, EmptyOrUnknownModelsAreRefused) {
    expectError<UsageError>("", {"empty", "lambert", "ggx"});
    expectError<UsageError>("gxx",
                            {"unknown model 'gxx'", "did you mean 'ggx'", "known: ", "ward"});
    expectError<UsageError>("wrad:ax=1", {"unknown model 'wrad'", "did you mean 'ward'"});
    expectError<UsageError>("zzzzzz:a=b", {"unknown model 'zzzzzz'", "lambert"});
    expectError<UsageError>(":", {"unknown model ''"});
    expectError<UsageError>("preset:", {"unknown preset ''", "hsh-ward"});
    expectError<UsageError>("preset:hsh-wrd", {"did you mean 'hsh-ward'"});
    expectError<UsageError>("Lambert", {"did you mean 'lambert'"});
}

TEST(Spec, UnknownKeyListsTheValidOnes) {
    expectError<UsageError>("ward:az=1", {"ward", "'az'", "kd, ks, ax, ay, variant"});
    expectError<UsageError>("phong:exp=1", {"'exp'", "did you mean 'exponent'"});
    expectError<UsageError>("lambert:KD=1", {"'KD'", "valid: kd"});
}

TEST(Spec, MalformedItemsAreRefused) {
    for (const std::string item :
         {"exponent", "exponent=", "=3", ",", "exponent=3,", ",exponent=3"})
        expectError<UsageError>("phong:" + item, {"phong", "key=value"});
    expectError<UsageError>("phong:exponent=1,exponent=1", {"exponent", "twice"});
    expectError<UsageError>("ward:ax=1,ay=1,variant=duer,variant=1992", {"variant", "twice"});
    expectError<UsageError>("phong:kd=1", {"phong", "exponent has to be given", "0 to"});
    expectError<UsageError>("ward", {"ax has to be given"});
}

// For every numeric parameter of every model: the key, the value and the range are named.
TEST(Spec, EveryNumberIsChecked) {
    for (const Model& model : models())
        for (const Parameter& parameter : model.parameters) {
            if (parameter.kind == Parameter::Kind::choice) continue;
            const std::string key(parameter.name), head = std::string(model.name) + ":" + key + "=";
            const std::string range = validValues(parameter);
            EXPECT_LT(parameter.min, parameter.max);
            for (const std::string value : {"nan", "inf", "-inf", "1e999", "1e400"})
                expectError<UsageError>(head + value,
                                        {key + "=" + value, "not a finite number", range});
            for (const std::string value : {"x", "1x", "0x10", " 1", "1 ", "+1", "--1"})
                expectError<UsageError>(head + value,
                                        {key + "='" + value + "'", "not a number", range});
            for (const double value : {parameter.min - 1, parameter.max * 1.001 + 1, -1e300, 1e300})
                expectError<UsageError>(head + std::to_string(value),
                                        {key + "=", "out of range", range});
            expectError<UsageError>(head + "1/2", {key + "=1/2", "2 values", range});
            expectError<UsageError>(head + "1/2/3/4", {"4 values", range});
            if (parameter.kind == Parameter::Kind::number)
                expectError<UsageError>(head + "1/1/1",
                                        {"3 values", "one number for all channels", range});
            else
                expectError<UsageError>(head + "0/0/" + std::to_string(parameter.min - 1),
                                        {"out of range", range});
        }
}

TEST(Spec, EveryChoiceIsChecked) {
    for (const Model& model : models())
        for (const Parameter& parameter : model.parameters) {
            if (parameter.kind != Parameter::Kind::choice) continue;
            ASSERT_GE(parameter.choices.size(), 2u);
            const std::string head = std::string(model.name) + ":" + std::string(parameter.name);
            expectError<UsageError>(head + "=other", {std::string(parameter.name), "'other'",
                                                      std::string(parameter.choices.back())});
        }
}

TEST(Spec, MicrofacetsTakeAlphaOrBothAxes) {
    for (const std::string model : {"ggx", "beckmann"}) {
        const Direction wi = directionFromAngles(.3, 1), wo = directionFromAngles(.4, 4);
        EXPECT_EQ(evaluate(*open(model + ":alpha=.3"), wi, wo),
                  evaluate(*open(model + ":ax=.3,ay=.3"), wi, wo));
        for (const std::string wrong :
             {"", ":ax=.3", ":ay=.3", ":alpha=.3,ax=.3", ":alpha=.3,ax=.3,ay=.3"})
            expectError<UsageError>(model + wrong, {model, "either alpha or both ax and ay"});
    }
}

TEST(Catalog, TableLinesAreComplete) {
    std::set<std::string_view> names;
    for (const Model& model : models()) {
        EXPECT_TRUE(names.insert(model.name).second) << model.name;
        EXPECT_FALSE(model.help.empty()) << model.name;
        EXPECT_FALSE(model.source.empty()) << model.name;
        std::set<std::string_view> keys;
        for (const Parameter& parameter : model.parameters) {
            EXPECT_TRUE(keys.insert(parameter.name).second) << parameter.name;
            EXPECT_FALSE(parameter.help.empty()) << parameter.name;
        }
    }
}

TEST_F(Files, AbsentFilesFoldersAndUnknownFormatsAreRefused) {
    expectError<InputError>((folder_ / "absent.binary").string(),
                            {"absent.binary", "no such file"});
    expectError<InputError>("absent.bsdf", {"no such file"});
    expectError<InputError>(folder_.string(), {"is a directory"});
    expectError<InputError>(write("empty.bsdf", ""), {"is empty"});
    expectError<InputError>(write("notes.txt", "nothing of the kind"),
                            {"notes.txt", "no known format"});
    expectError<InputError>("/dev/null", {"not a regular file"});
}

const std::string wardPreset =
    R"({"format":"hshfit-preset","version":1,"model":"ward","fit":{"error":0.1},
        "parameters":{"ax":0.2,"ay":0.5,"kd":[0.1,0.2,0.3],"variant":"duer"},"source":"a test"})";

TEST_F(Files, PresetOpensItsModel) {
    const std::string path = write("a:b.json", wardPreset);  // a colon in a name is no option
    EXPECT_EQ(open(path)->name(), "ward:kd=0.1/0.2/0.3,ax=0.2,ay=0.5,variant=duer");
    expectError<UsageError>(path + ":interpolation=nearest", {"takes no options", "interpolation"});
}

// A model's name goes before a file of that name; any path to it opens the file.
TEST_F(Files, ModelNamesGoFirst) {
    const std::string path = write("lambert/phong.json", wardPreset);
    const fs::path before = fs::current_path();
    fs::current_path(folder_);
    EXPECT_EQ(open("lambert")->name(), "lambert");
    EXPECT_NO_THROW(open("lambert/phong.json"));
    fs::current_path(before);
}

TEST_F(Files, InvalidPresetsAreRefused) {
    const std::string where = "bad.json";
    const auto expectBad = [&](const std::string& text, const std::vector<std::string>& parts) {
        std::vector<std::string> all{where};
        all.insert(all.end(), parts.begin(), parts.end());
        expectError<InputError>(write(where, text), all);
    };
    // Cut off anywhere it is an error, never a crash or another material.
    for (std::size_t length = 1; length < wardPreset.size(); ++length)
        expectBad(wardPreset.substr(0, length), {"not valid JSON"});

    const std::string head = R"({"format":"hshfit-preset","version":1,)";
    expectBad("[]", {"format"});
    expectBad("3", {"format"});
    expectBad("{}", {"format"});
    expectBad(R"({"format":3})", {"format"});
    expectBad(R"({"format":"hshfit-coefficients","version":1})", {"hshfit-preset"});
    expectBad(R"({"format":"hshfit-preset","version":2})", {"version"});
    expectBad(R"({"format":"hshfit-preset","version":"1"})", {"version"});
    expectBad(head + R"("parameters":{}})", {"model"});
    expectBad(head + R"("model":7,"parameters":{}})", {"model"});
    expectBad(head + R"("model":"lambert"})", {"parameters"});
    expectBad(head + R"("model":"lambert","parameters":[]})", {"parameters"});
    expectBad(head + R"("model":"lambert","parameters":{},"source":1})", {"source"});
    expectBad(head + R"("model":"gxx","parameters":{}})", {"unknown model 'gxx'"});
    expectBad(head + R"("model":"preset:hsh-ward","parameters":{}})", {"unknown model"});
    expectBad(head + R"("model":"phong:exponent=3","parameters":{}})", {"unknown model"});
    expectBad(head + R"("model":"phong","parameters":{}})", {"exponent has to be given"});
    expectBad(head + R"("model":"phong","parameters":{"exponent":-1}})", {"exponent=-1", "range"});
    expectBad(head + R"("model":"phong","parameters":{"exponent":1e999}})", {"not valid JSON"});
    expectBad(head + R"("model":"phong","parameters":{"exponent":null}})", {"exponent"});
    expectBad(head + R"("model":"phong","parameters":{"exponent":[1,2]}})", {"exponent"});
    expectBad(head + R"("model":"phong","parameters":{"exponent":"1,ks=2"}})", {"exponent"});
    expectBad(head + R"("model":"phong","parameters":{"exponent=1,ks":2}})", {"exponent=1,ks"});
    expectBad(std::string(1 << 21, ' '), {"too many"});
    expectBad(std::string(100000, '['), {"not valid JSON"});
}

TEST(Presets, AllOpenAndNameTheirSource) {
    EXPECT_GE(presets().size(), 2u);
    for (const Preset& preset : presets()) {
        const std::string spec = "preset:" + std::string(preset.name);
        EXPECT_NO_THROW(open(spec)) << spec;
        EXPECT_GT(parsePreset(preset.text, spec).source.size(), 20u) << spec;
        EXPECT_FALSE(preset.help.empty());
    }
    // The HSH paper's figure 5, as design and captions state it.
    EXPECT_EQ(open("preset:hsh-ward")->name(), "ward:ax=0.2,ay=0.5");
}

}  // namespace
}  // namespace hshfit::brdfs
