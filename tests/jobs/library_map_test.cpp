// The map of a library: its answer against the library's own functions, and its page; searches,
// and errors that learning states.

#include "job_fixture.h"

#include <brdfs/catalog.h>

#include <hshfit/error.h>
#include <hshfit/files/checksum.h>
#include <hshfit/material_library/library_file.h>
#include <hshfit/material_library/log_terms.h>

#include <jobs/library/library_map.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <regex>
#include <set>

namespace {

using namespace hshfit;
using nlohmann::json;
namespace fs = std::filesystem;
namespace ml = material_library;

class LibraryMaps : public test::JobFiles {
protected:
    /// Materials in colours and in grey; the last two are alike.
    static constexpr const char* specs[] = {"lambert:kd=.1/.5/.3+ggx:alpha=.25,F0=.05",
                                            "lambert:kd=.5/.5/.1",
                                            "oren-nayar:sigma=.5,kd=.6/.3/.3",
                                            "ggx:alpha=.4,F0=.04",
                                            "ggx:alpha=.3,F0=.8/.7/.6",
                                            "lambert:kd=.02",
                                            "ggx:alpha=.2,F0=.9/.6/.3",
                                            "ggx:alpha=.202,F0=.9/.6/.3"};

    /// The library of these, learned once.
    void learn(const std::string& name) const {
        static std::string bytes;
        if (bytes.empty()) {
            learnFrom({std::begin(specs), std::end(specs)}, name);
            bytes = Cli::read(path(name));
        }
        write(name, bytes);
    }
    void learnFrom(const std::vector<std::string>& words, const std::string& name) const {
        std::string call =
            "library learn --components 6 --limit 10 --limit-maximum 10"
            " --limit-flip 1 --force -o " +
            path(name);
        for (const std::string& word : words) call += " '" + word + "'";
        runProgram(call);
    }

    json map(const std::string& library, const std::string& page,
             const std::string& more = "") const {
        const std::string answer =
            runProgram("library map " + path(library) + " --json -o " + path(page) + " " + more);
        EXPECT_TRUE(keepsSchema(answer, "library"));
        return json::parse(answer);
    }

    /// A library of this many materials of one constant, ln(f + 0.001), each.
    std::string flatLibrary(std::size_t count, double level = -2) const {
        ml::Library library;
        for (std::size_t m = 0; m < count; ++m) {
            ml::Material material{.name = fmt::format("m{:04}", m),
                                  .source = "made",
                                  .kind = ml::Kind::polynomial,
                                  .channels = 1};
            material.polynomial = {std::vector<double>(ml::logTerms().size(), 0.0), {level}};
            material.polynomial.exponents[0] = level;
            material.bytes = material.polynomial.bytes();
            library.materials.push_back(std::move(material));
        }
        const std::string file = path(fmt::format("{}.library", count));
        AtomicFile written(file);
        ml::writeLibrary(library, written);
        written.commit();
        return file;
    }
};

TEST_F(LibraryMaps, FindsTheTwoThatLookAlikeAndNoOthers) {
    learn("a.library");
    const json found = map("a.library", "a.html");
    ASSERT_EQ(found["materials"].size(), std::size(specs));
    ASSERT_EQ(found["duplicates"].size(), 1u);
    const json& pair = found["duplicates"][0];
    EXPECT_EQ(pair["first"], "ggx_alpha=.202_F0=.9_.6_.3");
    EXPECT_EQ(pair["second"], "ggx_alpha=.2_F0=.9_.6_.3");
    EXPECT_EQ(map("a.library", "b.html", "--near 0")["duplicates"].size(), 0u);
    // With a bound that all pictures keep, every pair of neighbours is one.
    std::set<std::pair<std::string, std::string>> neighbours;
    for (const json& one : found["materials"]) {
        for (const json& other : one["nearest"]) {
            const std::string a = one["name"], b = other["name"];
            neighbours.insert(std::minmax(a, b));
        }
    }
    EXPECT_EQ(map("a.library", "c.html", "--near 1")["duplicates"].size(), neighbours.size());
}

TEST_F(LibraryMaps, DistancesAreThoseOfTheLibraryAndNeighboursTheirLeast) {
    learn("a.library");
    const json found = map("a.library", "a.html");
    const ml::Library library = ml::readLibrary(path("a.library"));
    const ml::LogSpace space;
    for (std::size_t m = 0; m < library.materials.size(); ++m) {
        std::vector<double> row;
        for (std::size_t k = 0; k < library.materials.size(); ++k) {
            if (k == m) continue;
            const double known =
                ml::distance(space, *ml::logMaterial(library, library.materials[m]),
                             *ml::logMaterial(library, library.materials[k]));
            EXPECT_NEAR(found["distances"][std::max(m, k)][std::min(m, k)], known, 1e-6);
            row.push_back(known);
        }
        std::ranges::sort(row);
        const json& nearest = found["materials"][m]["nearest"];
        ASSERT_EQ(nearest.size(), 5u);
        for (std::size_t k = 0; k < 5; ++k) EXPECT_NEAR(nearest[k]["distance"], row[k], 1e-6);
    }
}

TEST_F(LibraryMaps, NumbersOfMaterialsAreInOrderOfWhatTheyMean) {
    learn("a.library");
    std::map<std::string, json> rows;
    const json answer = map("a.library", "a.html");
    for (const json& row : answer["materials"]) rows[row["name"]] = row;
    const json &black = rows.at("lambert_kd=.02"), &olive = rows.at("lambert_kd=.5_.5_.1"),
               &gold = rows.at("ggx_alpha=.2_F0=.9_.6_.3");
    EXPECT_NEAR(black["albedo"], 0.02, 0.002);
    EXPECT_NEAR(olive["albedo"], 0.5 - 0.4 * 0.0722, 0.03);
    EXPECT_LT(black["chroma"], 0.5);
    EXPECT_GT(olive["chroma"], 40);
    EXPECT_NEAR(olive["hue"], 107, 5);  // CIE L*a*b* of (0.5, 0.5, 0.1)
    EXPECT_NEAR(olive["gloss"], 0.0213, 0.004);
    EXPECT_GT(gold["gloss"], 5 * olive["gloss"].get<double>());
    // Glossy materials lie to the right of the middle in the mean.
    double sum = 0;
    for (const auto& [name, row] : rows)
        sum += (row["gloss"].get<double>() > 0.1 ? 1 : -1) * row["place"]["x"].get<double>();
    EXPECT_GT(sum, 0);
}

TEST_F(LibraryMaps, PagesDependOnNoOrderOfInputsAndNoNumberOfThreads) {
    fs::create_directories(path("1"));
    fs::create_directories(path("2"));
    learn("1/a.library");
    learnFrom({std::rbegin(specs), std::rend(specs)}, "2/a.library");
    const auto page = [&](const std::string& folder, const std::string& more) {
        runProgram("library map " + path(folder + "/a.library") + " --force -o " +
                   path(folder + "/a.html") + more);
        std::string text = read(path(folder + "/a.html"));
        for (std::size_t at = text.find(path(folder)); at != text.npos;
             at = text.find(path(folder)))
            text.erase(at, path(folder).size());
        return text;
    };
    const std::string one = page("1", " --threads 1");
    EXPECT_EQ(one, page("1", " --threads 4"));
    EXPECT_EQ(one, page("2", ""));
}

TEST_F(LibraryMaps, ThePageStandsAloneWithAPictureOfEach) {
    learn("a.library");
    const json answer = map("a.library", "a.html");
    const std::string page = read(path("a.html"));
    EXPECT_EQ(page.find("{{"), page.npos);
    EXPECT_FALSE(std::regex_search(page, std::regex("(src|href)=\"(?!data:)")));
    EXPECT_EQ(page.find("@import"), page.npos);
    EXPECT_EQ(page.find("fetch("), page.npos);
    const std::string start = "<script type=\"application/json\" id=\"data\">";
    const std::size_t from = page.find(start) + start.size();
    const json data = json::parse(page.substr(from, page.find("</script>", from) - from));
    ASSERT_EQ(data["materials"].size(), answer["materials"].size());
    for (std::size_t m = 0; m < data["materials"].size(); ++m) {
        json row = data["materials"][m];
        // The signature, and the size in the first chunk (PNG 11.2.2).
        const std::string png = row["png"];
        const std::string head("\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\0\x48\0\0\0\x48", 24);
        EXPECT_EQ(png.substr(0, 32), base64(head)) << row["name"];
        row.erase("png");
        row.erase("colour");
        EXPECT_EQ(row, answer["materials"][m]);
    }
}

TEST_F(LibraryMaps, AMaterialWithAHalfwayFormHasAPlaceToo) {
    runProgram(
        "library learn lambert:kd=.2 lambert:kd=.6 ggx:alpha=.3,F0=.5 "
        "ward:kd=.2,ks=.2,ax=.1,ay=.4 --limit-flip 1 -o " +
        path("a.library"));
    const json found = map("a.library", "a.html");
    std::size_t halfway = 0;
    for (const json& row : found["materials"]) {
        if (row["kind"] != "halfway") continue;
        ++halfway;
        for (const json& one : row["nearest"]) EXPECT_GT(one["distance"], 0.05);
    }
    EXPECT_EQ(halfway, 1u);
}

TEST_F(LibraryMaps, ManyMaterialsAreRefusedAndOneIsEnough) {
    const std::string one = flatLibrary(1), many = flatLibrary(jobs::mostMapped + 1);
    expectError("library map " + many + " -o " + path("x.html"), 3,
                "has 1001 materials; a map shows 1 to 1000", 2);
    const jobs::LibraryMap map = jobs::mapLibrary(one, path("one.html"), {});
    EXPECT_EQ(map.materials.size(), 1u);
    EXPECT_EQ(map.width, 1);
    EXPECT_EQ(map.height, 1);
    EXPECT_TRUE(map.materials[0].neighbours.empty());
}

// 60 is the greatest bound that a file may have.
TEST_F(LibraryMaps, TheBrightestMaterialsOfAFileHaveFiniteNumbers) {
    flatLibrary(3, 60);
    const json found = map("3.library", "x.html");
    for (const json& row : found["materials"]) {
        EXPECT_GT(row["albedo"], 1e20);
        EXPECT_TRUE(std::isfinite(row["place"]["x"].get<double>()));
        for (const json& other : row["nearest"]) {
            EXPECT_EQ(other["distance"], 0);
            EXPECT_EQ(other["flip"], 0);
        }
    }
}

/// `search` looks at pictures of eight candidates for one answer: halfway forms are as far as their
/// projections are, and leave room for nearer materials of the basis.
TEST_F(LibraryMaps, SearchMeetsTheNearestAmongManyHalfwayForms) {
    learnFrom({specs[1], specs[3], "ggx:ax=.1,ay=.4,F0=.9"}, "few.library");
    ml::Library library = ml::readLibrary(path("few.library"));
    const auto own = std::ranges::find(library.materials, ml::Kind::halfway, &ml::Material::kind);
    ASSERT_NE(own, library.materials.end());
    const ml::Material brushed = *own;
    for (const char* name : {"a1", "a2", "a3", "a4", "a5", "a6", "a7", "a8", "a9"}) {
        library.materials.push_back(brushed);
        library.materials.back().name = name;
    }
    std::ranges::sort(library.materials, {}, &ml::Material::name);
    AtomicFile written(path("many.library"));
    ml::writeLibrary(library, written);
    written.commit();
    const auto first = [&](const std::string& spec) {
        const std::string found = runProgram("library search " + path("many.library") + " '" +
                                             spec + "' --count 1 --json");
        EXPECT_TRUE(keepsSchema(found, "library"));
        return json::parse(found)["found"][0];
    };
    EXPECT_EQ(first(specs[1])["name"], "lambert_kd=.5_.5_.1");
    const json metal = first("ggx:ax=.1,ay=.4,F0=.9");
    EXPECT_EQ(metal["name"], "a1");
    const ml::LogSpace space;
    const auto inTerms = [&](const std::string& spec) {
        return space.project(*brdfs::open(spec), "x", "x").material();
    };
    EXPECT_NEAR(metal["distance"],
                ml::distance(space, inTerms("ggx:ax=.1,ay=.4,F0=.9"),
                             inTerms(path("many.library") + ":a1")),
                1e-9);
}

class LearnedLibraries : public LibraryMaps {};

/// `learn` has no source when codes are there: it states FLIP from two errors, `encode` draws it.
TEST_F(LearnedLibraries, StateTheFlipThatEncodeMeasures) {
    std::string learned =
        "library learn --components 4 --bytes 30 --limit 10 --limit-maximum 10"
        " --limit-flip .99 --json -o " +
        path("a.library");
    for (const char* spec : specs) learned += std::string(" '") + spec + "'";
    runProgram(learned);
    const json list = json::parse(runProgram("library list " + path("a.library") + " --json"));
    ASSERT_EQ(list["materials"].size(), std::size(specs));
    for (const json& one : list["materials"]) {
        const json encoded = json::parse(runProgram("library encode " + path("a.library") + " '" +
                                                    one["source"].get<std::string>() +
                                                    "' --json --force -o " + path("b.library")));
        const double drawn = encoded["picture"]["flip"]["mean"];
        EXPECT_NEAR(one["error"]["flip"], drawn, 0.06 * drawn) << one["name"];
    }
}

TEST_F(LibraryMaps, BadInputEndsInOneLineWithoutAFile) {
    write("no.library", "not a library");
    const std::string call = "library map " + path("no.library");
    expectError(call + " -o " + path("x.html"), 3, "no.library", 1);
    expectError("library map " + path("absent") + " -o " + path("x.html"), 3, "absent", 1);
    expectError(call, 2, "needs -o", 1);
    expectError(call + " --near 2 -o " + path("x.html"), 2, "near", 1);
    expectError(call + " --count 2 -o " + path("x.html"), 2, "--count", 1);
}

}  // namespace
