// Collections of presets: every material opens and keeps its model's laws, the numbers are the
// published ones, and what is said about wrong names and files.

#include "models_grid.h"
#include "places.h"

#include <brdfs/catalog/preset.h>
#include <brdfs/presets/preset_collection.h>
#include <gtest/gtest.h>
#include <hshfit/error.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <regex>
#include <sstream>
#include <thread>

namespace hshfit::brdfs {
namespace {

namespace fs = std::filesystem;

/// Every material of every collection: "COLLECTION/MATERIAL".
std::vector<std::string> allNames() {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < presetCollections().size(); ++i)
        for (const auto& material : presetCollection(i).materials)
            names.push_back(std::string(presetCollections()[i].name) + "/" + material.name);
    return names;
}

template <class E>
void expectError(const std::function<void()>& act, const std::vector<std::string>& parts) {
    try {
        act();
        ADD_FAILURE() << "no error";
    } catch (const E& error) {
        const std::string message = error.what();
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        for (const std::string& part : parts)
            EXPECT_NE(message.find(part), std::string::npos) << message << "\nlacks: " << part;
    }
}

// 86 materials of MERL's 100 in each of Ngan's seven tables, all 100 in the others.
TEST(Collections, HoldTheWholePublishedTables) {
    ASSERT_EQ(presetCollections().size(), 14u);
    for (std::size_t i = 0; i < presetCollections().size(); ++i) {
        const std::string name(presetCollections()[i].name);
        const PresetCollection& collection = presetCollection(i);
        EXPECT_EQ(collection.materials.size(), name.starts_with("ngan-") ? 86u : 100u) << name;
        EXPECT_NE(collection.source.find("10."), std::string::npos) << name << ": no DOI";
        EXPECT_FALSE(collection.help.empty()) << name;
        EXPECT_EQ(findPresetCollection(name), i);
    }
    EXPECT_EQ(allNames().size(), 1302u);
}

/// Directions at 0, 40, 70 and 89.99 degrees, at an odd azimuth.
std::vector<Direction> outgoing() {
    std::vector<Direction> all{{0, 0, 1}};
    for (const double degrees : {40., 70., 89.99})
        all.push_back(directionFromAngles(radians(degrees), .3));
    return all;
}

TEST(Collections, EveryMaterialIsFiniteAndKeepsItsLaws) {
    Directions directions(61);
    std::vector<Direction> incoming{{0, 0, 1}};
    for (const double degrees : {20., 60., 85., 89.99})
        for (const double phi : {0., 2.})
            incoming.push_back(directionFromAngles(radians(degrees), phi));
    for (int i = 0; i < 8; ++i) incoming.push_back(directions.next());

    for (const std::string& name : allNames()) {
        SCOPED_TRACE(name);
        const auto brdf = open("preset:" + name);
        const Laws& laws = brdf->laws();
        EXPECT_TRUE(laws.nonNegative && laws.reciprocal && laws.isotropic && laws.mirrorSymmetric);
        double largest = 0;
        for (const Direction& wo : outgoing()) {
            std::vector<Direction> all = incoming;
            all.push_back(mirrored(wo));
            all.push_back(directions.near(mirrored(wo), 1e-3));
            for (const Direction& wi : all) {
                const std::vector<double> f = evaluate(*brdf, wi, wo);
                const std::vector<double> swapped = evaluate(*brdf, wo, wi);
                const std::vector<double> turned =
                    evaluate(*brdf, rotateAboutZ(wi, 1.1), rotateAboutZ(wo, 1.1));
                for (std::size_t c = 0; c < f.size(); ++c) {
                    ASSERT_TRUE(std::isfinite(f[c]));
                    ASSERT_GE(f[c], 0);
                    ASSERT_NEAR(f[c], swapped[c], 1e-11 * f[c]);
                    ASSERT_NEAR(f[c], turned[c], 1e-7 * f[c] + 1e-30);
                    largest = std::max(largest, f[c]);
                }
            }
        }
        EXPECT_GT(largest, 0) << "black";
    }
}

TEST(Collections, NameOpensTheSameBrdf) {
    for (const std::string& name : allNames()) {
        const auto brdf = open("preset:" + name), again = open(brdf->name());
        EXPECT_EQ(again->name(), brdf->name()) << name;
        const Direction wi = directionFromAngles(.5, 1), wo = directionFromAngles(.51, 4.1);
        EXPECT_EQ(evaluate(*brdf, wi, wo), evaluate(*again, wi, wo)) << name;
    }
}

TEST(Collections, AreParsedOnceByAnyThread) {
    std::vector<const PresetCollection*> seen(8);
    std::vector<std::thread> threads;
    for (auto& slot : seen) threads.emplace_back([&slot] { slot = &presetCollection(3); });
    for (std::thread& thread : threads) thread.join();
    for (const auto* collection : seen) EXPECT_EQ(collection, seen.front());
}

// --- the published numbers -----------------------------------------------------------------------

using Row = std::map<std::string, std::vector<double>>;

/// A line "NAME = Aggregate(Lambertian(albedo = [..]), Model(key = value, …))" of the tables as
/// they were re-typed elsewhere. A matrix becomes key.0, key.1.
std::map<std::string, Row> readFits(const fs::path& path) {
    std::map<std::string, Row> rows;
    std::ifstream file(path);
    const std::regex pair(R"((\w+) = (\[\[.*?\]\]|\[.*?\]|[-+.0-9eE]+))");
    const std::regex number(R"([-+]?[0-9.]+(?:[eE][-+]?[0-9]+)?)");
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with('#') || line.empty()) continue;
        const std::size_t equals = line.find(" = ");
        const std::string values = line.substr(equals + 3);
        Row row;
        for (std::sregex_iterator i(values.begin(), values.end(), pair), end; i != end; ++i) {
            std::vector<double> numbers;
            const std::string list = (*i)[2];
            for (std::sregex_iterator n(list.begin(), list.end(), number); n != end; ++n)
                numbers.push_back(std::stod(n->str()));
            const std::string key = row.empty() ? "kd" : (*i)[1].str();
            if (list.starts_with("[[")) {
                row[key + ".0"] = {numbers.begin(), numbers.begin() + 3};
                row[key + ".1"] = {numbers.begin() + 3, numbers.end()};
            } else {
                row[key] = numbers;
            }
        }
        rows[line.substr(0, equals)] = row;
    }
    return rows;
}

struct Table {
    std::string collection, file;
    std::map<std::string, std::string> keys;  ///< ours: theirs
    bool scaled = false;
};

const std::vector<Table> tables{
    {"ngan-ward", "ngan_ward", {{"ks", "albedo"}, {"ax", "roughness"}, {"ay", "roughness"}}, true},
    {"ngan-ward-duer",
     "ngan_wardduer",
     {{"ks", "albedo"}, {"ax", "roughness"}, {"ay", "roughness"}},
     true},
    {"ngan-blinn-phong", "ngan_blinnphong", {{"ks", "albedo"}, {"exponent", "sharpness"}}, true},
    {"ngan-cook-torrance",
     "ngan_cooktorrance",
     {{"ks", "albedo"}, {"F0", "eta"}, {"m", "roughness"}},
     true},
    {"ngan-ashikhmin-shirley",
     "ngan_ashikhminshirley",
     {{"ks", "albedo"}, {"Rs", "fresnelReflectance"}, {"nu", "sharpness"}, {"nv", "sharpness"}},
     true},
    {"ngan-lafortune",
     "ngan_lafortune",
     {{"ks", "albedo"}, {"Cx", "Cxy"}, {"Cy", "Cxy"}, {"Cz", "Cz"}, {"exponent", "sharpness"}},
     true},
    {"ngan-he",
     "ngan_he",
     {{"ks", "albedo"}, {"tau", "autocorrelation"}, {"sigma", "roughness"}, {"ior", "eta"}},
     true},
    {"low-ashikhmin-shirley-e1",
     "low_ashikhminshirley_E1",
     {{"ks", "albedo"}, {"nu", "sharpness"}, {"nv", "sharpness"}, {"ior", "fresnelReflectance"}}},
    {"low-ashikhmin-shirley-e2",
     "low_ashikhminshirley_E2",
     {{"ks", "albedo"}, {"nu", "sharpness"}, {"nv", "sharpness"}, {"ior", "fresnelReflectance"}}},
    {"low-cook-torrance-e1",
     "low_cooktorrance_E1",
     {{"ks", "albedo"}, {"m", "roughness"}, {"ior", "eta"}}},
    {"low-cook-torrance-e2",
     "low_cooktorrance_E2",
     {{"ks", "albedo"}, {"m", "roughness"}, {"ior", "eta"}}},
    {"low-abc-smooth-e2", "low_lowsmooth_E2", {{"A", "A"}, {"B", "B"}, {"C", "C"}, {"ior", "eta"}}},
    {"low-abc-microfacet-e2",
     "low_lowmicrofacet_E2",
     {{"A", "A"}, {"B", "B"}, {"C", "C"}, {"ior", "eta"}}},
    {"bagher-sgd",
     "bagher_sgd",
     {{"ks", "albedo"},
      {"alpha", "alpha"},
      {"p", "p"},
      {"K", "K"},
      {"Lambda", "Lambda"},
      {"c", "c"},
      {"k", "k"},
      {"theta0", "theta0"},
      {"F0", "eta.0"},
      {"F1", "eta.1"}}}};

/// The values of one key in "model:key=a/b/c,…".
std::vector<double> valuesOf(const std::string& spec, const std::string& key) {
    const std::size_t found =
        spec.find((spec.find(":" + key + "=") == spec.npos ? "," : ":") + key + "=");
    std::vector<double> values;
    if (found == spec.npos) return values;
    std::istringstream stream(spec.substr(found + key.size() + 2));
    for (double value; stream >> value;) {
        values.push_back(value);
        if (stream.get() != '/') break;
    }
    return values;
}

TEST(Collections, HoldThePublishedNumbers) {
    const fs::path folder = fs::path(test::sharedFolder()) / "data/tables/bbm_fits";
    if (!fs::exists(folder)) GTEST_SKIP() << folder << " is absent";
    ASSERT_EQ(tables.size(), presetCollections().size());
    const double scale[3] = {1, 1.15, 1.66};
    for (const Table& table : tables) {
        const auto fits = readFits(folder / (table.file + ".fit"));
        const auto index = findPresetCollection(table.collection);
        ASSERT_TRUE(index) << table.collection;
        const PresetCollection& collection = presetCollection(*index);
        EXPECT_EQ(fits.size(), collection.materials.size());
        auto keys = table.keys;
        keys["kd"] = "kd";
        for (const auto& [name, row] : fits) {
            SCOPED_TRACE(table.collection + "/" + name);
            const auto* material = findMaterial(collection, name);
            ASSERT_NE(material, nullptr);
            for (const auto& [ours, theirs] : keys) {
                ASSERT_TRUE(row.contains(theirs)) << theirs;
                std::vector<double> expected = row.at(theirs);
                if (table.scaled && (ours == "kd" || ours == "ks"))
                    for (std::size_t c = 0; c < 3; ++c) expected[c] *= scale[c];
                EXPECT_EQ(valuesOf(material->spec, ours), expected) << ours;
            }
        }
    }
}

// --- names and files -----------------------------------------------------------------------------

TEST(Collections, WrongNamesAreAnsweredWithTheNearest) {
    const auto opening = [](const std::string& spec) { return [spec] { open(spec); }; };
    expectError<UsageError>(opening("preset:ngan-ward/blue-acrylik"), {"blue-acrylic"});
    expectError<UsageError>(opening("preset:ngan-ward/acrylic"), {"'blue-acrylic'", "nearest"});
    expectError<UsageError>(opening("preset:ngan-ward/Blue-Acrylic"), {"'blue-acrylic'"});
    expectError<UsageError>(opening("preset:ngan-ward/zzzzzzzz"), {"no material", "86"});
    expectError<UsageError>(opening("preset:ngan-ward"), {"name one of its materials", "86"});
    expectError<UsageError>(opening("preset:ngan-ward/"), {"name one of its materials"});
    expectError<UsageError>(opening("preset:ngan-wrd/blue-acrylic"),
                            {"unknown preset", "did you mean 'ngan-ward'", "bagher-sgd"});
    expectError<UsageError>(opening("preset:/blue-acrylic"), {"unknown preset"});
    expectError<UsageError>(opening("ngan-ward/blue-acrylic"),
                            {"did you mean preset:ngan-ward/blue-acrylic?"});
    expectError<UsageError>(opening("hsh-phong"), {"did you mean preset:hsh-phong?"});
}

TEST(Nearest, SubstringsThenWordsThenEdits) {
    const std::vector<std::string> names{"blue-acrylic", "blue-fabric", "white-acrylic", "brass"};
    const auto nearest = [&](const char* word) { return nearestNames(word, names, 2); };
    EXPECT_EQ(nearest("ACRYLIC"), (std::vector<std::string>{"blue-acrylic", "white-acrylic"}));
    EXPECT_EQ(nearest("acrylic-blue"), (std::vector<std::string>{"blue-acrylic"}));
    EXPECT_EQ(nearest("acrylik"), (std::vector<std::string>{"blue-acrylic", "white-acrylic"}));
    EXPECT_EQ(nearest("bleu-fabric"), (std::vector<std::string>{"blue-fabric"}));
    EXPECT_EQ(nearest("bras"), (std::vector<std::string>{"brass"}));
    EXPECT_EQ(nearest("brsas"), (std::vector<std::string>{"brass"}));
    EXPECT_TRUE(nearest("qqqqqqq").empty());
}

class CollectionFile : public testing::Test {
protected:
    void SetUp() override {
        std::string name = fs::path(testing::TempDir()) / "hshfit_collection_XXXXXX";
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        folder_ = name;
    }
    void TearDown() override { fs::remove_all(folder_); }

    std::string write(const std::string& text) const {
        const fs::path path = folder_ / "mine.json";
        std::ofstream(path, std::ios::binary) << text;
        return path.string();
    }
    fs::path folder_;
};

const std::string mine = R"({"format":"hshfit-presets","version":1,"model":"ward","help":"mine",
  "parameters":{"variant":"duer","ay":0.3},"source":"a test","correction":"none",
  "channel_scale":{"factors":[1,2,4],"parameters":["ks"]},
  "materials":{"one":{"kd":[0.1,0.2,0.3],"ks":0.05,"ax":0.2},
               "two:three":{"ks":[0.1,0.1,0.05],"ax":0.2,"ay":0.25}}})";

TEST_F(CollectionFile, OpensOneMaterial) {
    const std::string path = write(mine);
    EXPECT_EQ(open(path + ":one")->name(),
              "ward:kd=0.1/0.2/0.3,ks=0.05/0.1/0.2,ax=0.2,ay=0.3,variant=duer");
    EXPECT_EQ(parsePresetCollection(mine, "x").materials[1].name, "two:three");
    expectError<UsageError>([&] { open(path); }, {"mine.json", "name one", "'one', 'two:three'"});
    expectError<UsageError>([&] { open(path + ":onw"); }, {"no material 'onw'", "nearest: 'one'"});
}

TEST_F(CollectionFile, InvalidOnesAreRefused) {
    const auto expectBad = [&](const std::string& text, const std::vector<std::string>& parts) {
        std::vector<std::string> all{"here"};
        all.insert(all.end(), parts.begin(), parts.end());
        expectError<InputError>([&] { parsePresetCollection(text, "here"); }, all);
    };
    for (std::size_t length = 0; length < mine.size(); ++length)
        expectBad(mine.substr(0, length), {"not valid JSON"});
    const std::string head = R"({"format":"hshfit-presets","version":1,)";
    const std::string ward = head + R"("model":"ward",)", none = R"("materials":{})";
    expectBad(R"({"format":"hshfit-preset","version":1})", {"hshfit-presets"});
    expectBad(R"({"format":"hshfit-presets","version":2})", {"version"});
    expectBad(head + none + "}", {"model"});
    expectBad(head + R"("model":"ward:ax=1",)" + none + "}", {"unknown model"});
    expectBad(ward + R"("materials":[]})", {"materials"});
    expectBad(ward + R"("help":1})", {"help"});
    expectBad(ward + R"("parameters":[],)" + none + "}", {"parameters"});
    expectBad(ward + R"("materials":{"a":3}})", {"here/a", "object"});
    expectBad(ward + R"("materials":{"":{}}})", {"without a name"});
    expectBad(ward + R"("materials":{"a":{"ax":null}}})", {"here/a", "'ax'"});
    expectBad(ward + R"("materials":{"a":{"ax=1,ay":1}}})", {"here/a", "ax=1,ay"});
    for (const std::string scale :
         {"1", "[]", "{}", R"({"factors":[1,2],"parameters":[]})",
          R"({"factors":[1,2,"3"],"parameters":[]})", R"({"factors":[1,2,3],"parameters":"ks"})",
          R"({"factors":[1,2,3],"parameters":[1]})"})
        expectBad(ward + R"("channel_scale":)" + scale + "," + none + "}", {"channel_scale"});
    // An error that only the model can find shows on opening, with the material named.
    const std::string path =
        write(ward + R"("materials":{"a":{"ax":1},"b":{"ax":1,"ay":99},"c":{"az":1}}})");
    expectError<InputError>([&] { open(path + ":a"); }, {"mine.json/a", "ay has to be given"});
    expectError<InputError>([&] { open(path + ":b"); }, {"mine.json/b", "ay=99", "range"});
    expectError<InputError>([&] { open(path + ":c"); }, {"mine.json/c", "'az'"});
}

TEST(PresetFiles, KeepTheirSchemas) {
    if (std::system("/usr/bin/python3 -c 'import jsonschema' 2>/dev/null") != 0)
        GTEST_SKIP() << "python3-jsonschema is not installed";
    const std::string source = test::sourceFolder();
    const auto validate = [&](const std::string& schema, const std::string& files) {
        return std::system(("/usr/bin/python3 " + source + "/tests/validate_schema.py " + source +
                            "/docs/schemas/" + schema + ".schema.json " + source +
                            "/brdfs/presets/" + files + "-*.json")
                               .c_str());
    };
    EXPECT_EQ(validate("preset", "hsh"), 0);
    for (const std::string origin : {"ngan", "low", "bagher"})
        EXPECT_EQ(validate("presets", origin), 0) << origin;
}

}  // namespace
}  // namespace hshfit::brdfs
