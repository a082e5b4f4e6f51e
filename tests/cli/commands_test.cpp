// The program as a user meets it: exit codes, one-line errors, nothing half-written, the same bytes
// whatever the threads.

#include <cli/program.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <sstream>

namespace {

using hshfit::test::Answer;
using hshfit::test::Cli;

namespace fs = std::filesystem;

TEST_F(Cli, ConvertRepairsOnlyWhatIsAskedAndSaysSo) {
    const Answer plain = run("convert --json lambert:kd=.5 " + path("a.binary"));
    EXPECT_EQ(plain.out.find("repairs"), std::string::npos);
    const Answer bright =
        run("convert --repair energy --report-loss '1.5*lambert' " + path("c.binary"));
    ASSERT_EQ(bright.code, 0) << bright.err;
    EXPECT_NE(bright.out.find("energy changed 1111430 of 1111430 values"), std::string::npos)
        << bright.out;
    const std::string value = run("eval " + path("c.binary") + " --wi 30,0 --wo 40,90").out;
    EXPECT_NEAR(std::stod(value.substr(2)), 1 / M_PI, 1e-4);
    expectError("convert --repair energie lambert " + path("d.binary"), 2, "reciprocity", 2);
    expectError("convert lambert " + path("d.tiff"), 2, ".bsdf", 2);
    expectError("convert --to nope lambert " + path("d.binary"), 2, "bsdf-klems", 2);
    expectError("convert --to merl:size=3 lambert " + path("d.binary"), 2, "size", 2);
}

/// Spectra that stand for colours are compared as these colours.
TEST_F(Cli, ConvertStatesTheLossOfFilesForPbrt) {
    const auto lossOf = [&](const std::string& file, const std::string& options) {
        const Answer answer =
            run("convert ggx:alpha=.4,F0=.9/.5/.1 " + path(file) +
                " --to rgl:theta=8,slice=24,normals=32" + options + " --report-loss --json");
        EXPECT_EQ(answer.code, 0) << answer.err;
        EXPECT_TRUE(keepsSchema(answer.out, "convert"));
        const std::size_t loss = answer.out.find("\"relative-l2-cosine\"");
        const std::size_t value = answer.out.find("\"value\"", loss);
        return std::stod(answer.out.substr(answer.out.find(':', value) + 1));
    };
    const double colours = lossOf("a.bsdf", ""), spectra = lossOf("b.bsdf", ",for=pbrt");
    EXPECT_GT(colours, 1e-4);
    EXPECT_NEAR(spectra, colours, 1e-3 * colours);
    expectError("convert lambert " + path("c.bsdf") + " --to rgl:for=mitsuba", 2, "pbrt", 2);
}

/// A table of ten nodes cannot follow the lobe: the text has the number that the JSON has.
TEST_F(Cli, ConvertSaysHowFarTheFileIsOff) {
    const std::string call = "convert ggx:alpha=.1 --force --quiet " + path("a.alta");
    const Answer json = run(call + " --json"), text = run(call);
    ASSERT_EQ(text.code, 0) << text.err;
    const double error = std::stod(json.out.substr(json.out.find("\"error\": ") + 9));
    EXPECT_GT(error, 0.1);
    const std::string words = "  read back: ";
    const std::size_t at = text.out.find(words);
    ASSERT_NE(at, std::string::npos) << text.out;
    EXPECT_NEAR(std::stod(text.out.substr(at + words.size())), 100 * error, 0.5);
    EXPECT_NE(text.out.find("; FLIP "), std::string::npos) << text.out;
}

/// One number is one number, whether it is called grey or has the wavelength of the format.
TEST_F(Cli, ConvertStatesTheLossOfGreyAtOneWavelength) {
    const Answer answer = run("convert lambert:kd=.5 " + path("a.xompt") +
                              " --to xompt:theta=19,last=89.9 --report-loss --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "convert"));
    const std::size_t error = answer.out.find("\"error\": ");
    ASSERT_NE(error, std::string::npos) << answer.out;
    EXPECT_LT(std::stod(answer.out.substr(error + 9)), 0.1);
}

TEST_F(Cli, ConvertChecksTheDirectionsOfTheLossBeforeItWrites) {
    expectError("convert lambert " + path("a.alta") + " --report-loss --outgoing nan", 2,
                "outgoing directions 'nan'", 0);
    expectError("convert lambert " + path("a.alta") + " --outgoing 4", 2, "--report-loss", 0);
}

/// As of a variable of a shell that is not set.
TEST_F(Cli, EmptyValuesAreRefused) {
    expectError("project lambert -o ''", 2, "project: the value of --output is empty", 0);
    expectError("convert lambert ''", 2, "convert: the value of OUT is empty", 0);
    expectError("manual -o ''", 2, "--output is empty", 0);
    expectError("fit lambert --model lambert --sigma ''", 2, "--sigma is empty; give one", 0);
    expectError("compare lambert lambert --figures=", 2, "--figures", 0);
    expectError("info ''", 2, "empty BRDF specification", 0);
}

TEST_F(Cli, UsageErrorsNameWhatIsValid) {
    expectError("frobnicate", 2, "; see hshfit help", 0);
    expectError("tradeof lambert", 2, "did you mean 'tradeoff'", 0);
    expectError("project lambert --tolerence=1e-3 -o " + path("x.json"), 2,
                "did you mean '--tolerance'", 0);
    expectError("project lambert --frobnicate", 2,
                "project: unknown option '--frobnicate'; see hshfit help project", 0);
    expectError("project lambert --tolerance high -o " + path("x.json"), 2, "high", 0);
    expectError("export lambert --basis hsh --order 2.5 -o " + path("x"), 2,
                "--order '2.5': give a whole number; see", 0);
    expectError("project lambert --order 2.5 -o " + path("x.json"), 2,
                "'2.5' is no whole number in digits alone within 1 to", 0);
    expectError("light uniform --order 1e1 -o " + path("x.json"), 2, "no whole number", 0);
    expectError("light uniform --order 1001 -o " + path("x.json"), 2, "'1001' is not within 1 to",
                0);
    expectError("info ggx:alpha=0,3", 2, "a number has a point: alpha=0.3", 0);
    expectError("info lambert:kd=.2/.3/.4,5", 2, "a number has a point", 0);
    expectError("project lambert -o", 2, "--output: a value is missing; see", 0);
    expectError("info lambert -q", 2, "unexpected '-q'; see hshfit help info", 0);
    expectError("list presets acrylic of three paints", 2,
                "unexpected 'of three paints'; see hshfit help list", 0);
    expectError("-x", 2, "no command is given", 0);
    expectError("export x.json -o " + path("y") + " --sampling --no-sampling", 2,
                "--sampling and --no-sampling exclude one another; give one of them", 0);
    expectError("eval lambret --wi 0,0 --wo 0,0", 2, "lambert", 0);
    expectError("eval phong:expnent=3 --wi 0,0 --wo 0,0", 2, "exponent", 0);
    expectError("eval lambert --wi 0 --wo 0,0", 2, "THETA,PHI", 0);
    expectError("eval lambert --wi 120,0 --wo 0,0", 2, "0 to 90", 0);
    expectError("project lambert -o " + path("x.json") + " --basis hsw", 2, "zernike", 0);
    expectError("project lambert -o " + path("x.json") + " --order 0", 2, "order", 0);
    expectError("project lambert -o " + path("x.txt"), 2, ".json", 0);
    expectError("project lambert -o " + path("x.json") + " --outgoing 3y3", 2, "32x32", 0);
    expectError("project ward:ax=.1,ay=.2 -o " + path("x.json") + " --outgoing 8", 2, "anisotropic",
                0);
    expectError("compare lambert lambert --metrics nope", 2, "relative-l2", 0);
}

/// A document of JSON has no name of another format, and a folder that is not there is found before
/// the work: here before the input, which is not there either.
TEST_F(Cli, NamesOfOutputsAreCheckedBeforeTheWork) {
    expectError("light uniform -o " + path("sky.exr"), 2, "are written as .json", 0);
    expectError("gaussians ggx:alpha=.3 -o " + path("g.EXR"), 2, "are written as .json", 0);
    EXPECT_EQ(run("light uniform --order 1 -o " + path("sky.JSON")).code, 0);
    fs::remove(path("sky.JSON"));
    expectError("project " + path("none.binary") + " -o " + path("x.foo"), 2, ".json (exact)", 0);
    expectError("library learn lambert -o " + path("a.json"), 2, "a.library'", 0);
    for (const std::string command : {"project", "light", "gaussians", "library learn"})
        expectError(command + " " + path("none.binary") + " -o " + path("absent/x.json"), 5,
                    "absent/x.json': there is no folder '" + path("absent") + "'", 0);
    // Of several results, the folder is made.
    EXPECT_EQ(run("project lambert lambert:kd=.5 --order 1 -o " + path("new/")).code, 0);
    fs::remove_all(path("new"));
    expectError("convert " + path("none.binary") + " " + path("absent/x.bsdf"), 5,
                "there is no folder", 0);
    expectError("irradiance uniform --by-normal " + path("absent/x.csv"), 5, "there is no folder",
                0);
}

TEST_F(Cli, BadInputIsOneLineAndLeavesNothing) {
    write("empty.binary", "");
    write("noise.bsdf", "tensor_file");
    write("short.json", R"({"format":"hshfit-coefficients","version":1,)");
    write("columns.csv", "wi_x,wi_y,wi_z,wo_x,wo_y\n0,0,1,0,0\n");
    write("length.csv", "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z\n0,0,2,0,0,1\n");
    write("nan.csv", "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z\nnan,0,1,0,0,1\n");
    expectError("info " + path("empty.binary"), 3, "empty.binary", 6);
    expectError("info " + path("noise.bsdf"), 3, "noise.bsdf", 6);
    expectError("info " + path("short.json"), 3, "short.json", 6);
    expectError("eval " + folder_.string() + " --wi 0,0 --wo 0,0", 3, folder_.filename(), 6);
    expectError("project " + path("noise.bsdf") + " -o " + path("x.json"), 3, "noise.bsdf", 6);
    for (const char* csv : {"columns.csv", "length.csv", "nan.csv"}) {
        expectError("eval lambert --pairs " + path(csv) + " -o " + path("out.csv"), 3, csv, 6);
    }
}

TEST_F(Cli, NumbersThatDoNotExistEndInFour) {
    const Answer ward = run("report ward:ax=.2,ay=.5 --json --outgoing 45,0 --max-order 3");
    EXPECT_EQ(ward.code, 4);
    EXPECT_NE(ward.out.find("\"finite\": false"), std::string::npos);
    EXPECT_NE(ward.out.find("\"value\": null"), std::string::npos);
    EXPECT_NE(ward.err.find("--cosine"), std::string::npos);
    expectError("project ward:ax=.2,ay=.5,variant=duer -o " + path("x.json"), 4, "--cosine", 0);
    expectError(
        "project phong:exponent=1e6 --outgoing 45,0 --max-evaluations 1000 -o " + path("x.json"), 4,
        "not converged", 0);
}

TEST_F(Cli, OutputErrorsEndInFive) {
    expectError("project lambert --outgoing 0,0 -o " + path("absent/x.json"), 5, "absent", 0);
    EXPECT_EQ(run("list bases >/dev/full").code, 5);
}

TEST_F(Cli, ExtensionsMeanTheSameInCapitals) {
    for (const std::string extension : {"png", "exr"}) {
        const std::string command = "render lambert --size 16 --by integration -o ";
        std::string capitals = extension;
        for (char& c : capitals) c = static_cast<char>(std::toupper(c));
        ASSERT_EQ(run(command + path("a." + extension)).code, 0);
        const Answer answer = run(command + path("b." + capitals));
        ASSERT_EQ(answer.code, 0) << answer.err;
        EXPECT_EQ(read(path("b." + capitals)).substr(0, 8),
                  read(path("a." + extension)).substr(0, 8));
    }
    const Answer fitted = run("fit lambert --model lambert --starts 1 -o " + path("F.JSON"));
    EXPECT_EQ(fitted.code, 0) << fitted.err;
    EXPECT_TRUE(std::filesystem::is_regular_file(path("F.JSON")));
    EXPECT_EQ(run("convert lambert:kd=0.5 " + path("L.XML")).code, 0);
    EXPECT_EQ(run("info " + path("L.XML")).code, 0);
}

TEST_F(Cli, OneBrdfInAFolderNamesAFile) {
    for (const std::string& folder : {path(""), path("absent/")}) {
        const Answer answer = run("project lambert:kd=.5 -o " + folder);
        EXPECT_EQ(answer.code, 5);
        EXPECT_NE(answer.err.find(folder + "lambert_kd=.5.json"), std::string::npos) << answer.err;
    }
}

TEST_F(Cli, EvalPrintsTheFormula) {
    EXPECT_NEAR(std::stod(run("eval lambert:kd=.5 --wi 10,0 --wo 20,0").out.substr(5)), 0.5 / M_PI,
                1e-15);
    const std::string cosine = run("eval phong:exponent=3 --wi 60,0 --wo 50,180 --cosine").out;
    EXPECT_NEAR(std::stod(cosine.substr(5)), std::pow(std::cos(M_PI / 18), 3) * 0.5, 1e-14);
}

TEST_F(Cli, PairsIgnoreOtherColumnsAndRepeatGrey) {
    write("in.csv", "id,wi_x,wi_y,wi_z,wo_x,wo_y,wo_z\n7,0,0.6,0.8,0,0,1\n");
    const Answer answer = run("eval lambert --cosine --pairs " + path("in.csv"));
    EXPECT_EQ(answer.code, 0) << answer.err;
    std::stringstream lines(answer.out);
    std::string header, row;
    std::getline(lines, header);
    std::getline(lines, row);
    EXPECT_EQ(header, "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,r,g,b");
    const auto last = row.rfind(',');
    EXPECT_NEAR(std::stod(row.substr(last + 1)), 0.8 / M_PI, 1e-15);
}

/// f is 0 where a cosine is 0 (brdf.h): at angles of 90 degrees as at vectors with a z of 0.
TEST_F(Cli, TheHorizonHasOneValueInAnglesAndInVectors) {
    write("in.csv", "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z\n0,1,0,0.5,0,0.8660254037844386\n");
    for (const std::string spec : {"lambert", "ggx:alpha=.2"}) {
        const Answer below = run("eval " + spec + " --wi 90,90 --wo 30,0");
        ASSERT_EQ(below.code, 0) << below.err;
        EXPECT_EQ(below.out, "grey\t0\n") << spec;
        const Answer vectors = run("eval " + spec + " --pairs " + path("in.csv"));
        ASSERT_EQ(vectors.code, 0) << vectors.err;
        EXPECT_NE(vectors.out.find(",0,0,0\n"), std::string::npos) << vectors.out;
        EXPECT_EQ(run("eval " + spec + " --wi 30,0 --wo 90,0").out, "grey\t0\n") << spec;
    }
    EXPECT_NE(run("eval lambert --wi 89.99,0 --wo 0,0").out.find("0.318"), std::string::npos);
}

TEST_F(Cli, PairsMayBeInDegrees) {
    write("angles.csv",
          "theta_i,phi_i,theta_o,phi_o,expected_error\n30,0,60,180,0.1\n45,90,0,0,0.2\n");
    const Answer answer = run("eval ward:ax=.2,ay=.5 --pairs " + path("angles.csv"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    std::istringstream rows(answer.out);
    std::string row;
    std::getline(rows, row);
    EXPECT_EQ(row, "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,r,g,b");
    for (const char* pair : {"--wi 30,0 --wo 60,180", "--wi 45,90 --wo 0,0"}) {
        std::getline(rows, row);
        const std::string one = run(std::string("eval ward:ax=.2,ay=.5 ") + pair).out;
        const double expected = std::stod(one.substr(one.find('\t')));
        EXPECT_GT(expected, 0);
        EXPECT_NEAR(std::stod(row.substr(row.rfind(',') + 1)), expected, 1e-12 * expected) << row;
    }
    write("angles.csv", "theta_i,phi_i,theta_o\n30,0,60\n");
    expectError("eval lambert --pairs " + path("angles.csv"), 3, "phi_o", 1);
    write("angles.csv", "theta_i,phi_i,theta_o,phi_o\n30,0,190,0\n");
    expectError("eval lambert --pairs " + path("angles.csv"), 3, "0 to 180", 1);
    write("angles.csv", "theta_i,phi_i,theta_o,phi_o\n30,0,10,0\n30,0,x,0\n");
    expectError("eval lambert --pairs " + path("angles.csv"), 3, "line 3, column theta_o: 'x'", 1);
    write("angles.csv", "theta_i;phi_i;theta_o;phi_o\n30;0;10;0\n");
    expectError("eval lambert --pairs " + path("angles.csv"), 3, "has semicolons", 1);
}

TEST_F(Cli, PairsMayHaveEmptyLinesAndThoseBelowTheSurfaceAreCounted) {
    write("in.csv", "theta_i,phi_i,theta_o,phi_o\r\n30,0,60,0\r\n\r\n30,0,120,0\r\n\r\n");
    const Answer answer = run("eval lambert --pairs " + path("in.csv"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_EQ(std::count(answer.out.begin(), answer.out.end(), '\n'), 3) << answer.out;
    EXPECT_NE(answer.err.find("1 of 2 pairs have a direction below the surface"), std::string::npos)
        << answer.err;
    // Of a transmission, wo belongs there.
    const Answer through = run("eval lambert-transmission --pairs " + path("in.csv"));
    EXPECT_EQ(through.err.find("below the surface, where f is 0"), std::string::npos);
}

TEST_F(Cli, AnImpossibleOrderIsRefusedBeforeAnOldFile) {
    write("old.json", "{}");
    expectError("project lambert -o " + path("old.json") + " --order 0", 2, "order", 1);
    EXPECT_NE(run("project --help").out.find("1 to 2801"), std::string::npos);
}

TEST_F(Cli, SameBytesWhateverTheThreads) {
    const std::string job = "project ggx:alpha=.3 --cosine --order 5 --outgoing 12x12 ";
    ASSERT_EQ(run(job + "--threads 1 -o " + path("a.json")).code, 0);
    ASSERT_EQ(run(job + "--threads 2 -o " + path("b.json")).code, 0);
    EXPECT_EQ(read(path("a.json")), read(path("b.json")));
    EXPECT_FALSE(read(path("a.json")).empty());
}

TEST_F(Cli, CoefficientFilesReconstructTheSameFunction) {
    const std::string job = "project ggx:alpha=.5 --cosine --order 6 --outgoing 50,20 -o ";
    ASSERT_EQ(run(job + path("c.json")).code, 0);
    ASSERT_EQ(run(job + path("c.exr")).code, 0);
    const std::string at = " --wi 40,200 --wo 50,20";
    const double json = std::stod(run("eval " + path("c.json") + at).out.substr(5));
    const double exr = std::stod(run("eval " + path("c.exr") + at).out.substr(5));
    EXPECT_NEAR(json, exr, 1e-5 * std::abs(json));
    EXPECT_NEAR(json, std::stod(run("eval ggx:alpha=.5" + at).out.substr(5)), 0.3 * json);
}

TEST_F(Cli, ConvertWritesWhatIsReadBack) {
    ASSERT_EQ(run("convert lambert:kd=.5 " + path("l.binary")).code, 0);
    const std::string value = run("eval " + path("l.binary") + " --wi 30,0 --wo 40,90").out;
    EXPECT_NEAR(std::stod(value.substr(2)), 0.5 / M_PI, 1e-9);
    expectError("convert lambert " + path("l.binary"), 5, "l.binary", 1);
    EXPECT_EQ(run("convert lambert --force " + path("l.binary")).code, 0);
}

TEST_F(Cli, JsonAnswersKeepTheirSchemas) {
    if (std::system("/usr/bin/python3 -c 'import jsonschema' 2>/dev/null") != 0) {
        GTEST_SKIP() << "python3-jsonschema is not installed";
    }
    const std::pair<const char*, std::string> answers[] = {
        {"list", "list --json"},
        {"info", "info ggx:alpha=.4 --json"},
        {"help", "help losses --json"},
        {"manual", "manual --json --force -o " + path("man")},
        {"completion", "completion bash --json"},
        {"completion", "completion bash --json -- hshfit pro"},
        {"eval", "eval lambert --wi 0,0 --wo 0,0 --json"},
        {"project", "project lambert --outgoing 4 --json --force -o " + path("x.json")},
        {"report", "report phong:exponent=5 --outgoing 20,0 --max-order 4 --json"},
        {"stress", "stress lambert --max-order 8 --json"},
        {"compare", "compare lambert phong:exponent=2 --outgoing 4 --json"},
        {"light", "light sky:type=3 --order 4 --json --force -o " + path("l.json")},
        {"light", "light directional:elevation=40 --normal 30,0 --basis hsh --json --force -o " +
                      path("d.json")},
        {"irradiance", "irradiance sky:type=3 --normals 100 --window hann --json"},
        {"convert", "convert lambert --json --repair all --report-loss " + path("x.binary")}};
    for (const auto& [name, arguments] : answers) {
        const Answer answer = run(arguments);
        ASSERT_EQ(answer.code, 0) << arguments << answer.err;
        EXPECT_TRUE(keepsSchema(answer.out, name)) << name;
    }
}

}  // namespace
