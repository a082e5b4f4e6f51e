// Transmission as a user of the commands meets it: the direction below the surface, the side in
// every answer, and refusals in one line.

#include "places.h"

#include <cli/program.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>
#include <vector>

namespace {

using hshfit::test::Answer;
using hshfit::test::Cli;
using Json = nlohmann::json;

const std::string glass = "rough-glass:alpha=0.2";

class TransmissionCommands : public Cli {
protected:
    /// One line on standard error with `part`, and no other file in the folder.
    void refuses(const std::string& arguments, int code, const std::string& part) const {
        expectError(arguments, code, part,
                    std::distance(std::filesystem::directory_iterator(folder_), {}));
    }
};

TEST_F(TransmissionCommands, EvalTakesADirectionBelowTheSurface) {
    const Answer answer = run("eval lambert-transmission:kt=0.5 --wi 30,0 --wo 150,180 --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "eval"));
    const Json json = Json::parse(answer.out);
    EXPECT_EQ(json["side"], "transmission-front");
    EXPECT_NEAR(json["values"][0].get<double>(), .5 / M_PI, 1e-15);
    EXPECT_NEAR(json["wo"]["theta"].get<double>(), 150, 1e-9);
    std::ofstream(path("pairs.csv"))
        << "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z\n0,0,1,0,0,-1\n0,0,1,0,.6,-.8\n";
    const std::string pairs =
        "eval lambert-transmission:kt=.1/.2/.3 --json --pairs " + path("pairs.csv");
    const Answer all = run(pairs), written = run(pairs + " -o " + path("values.csv"));
    EXPECT_TRUE(keepsSchema(all.out, "eval")) << all.err;
    EXPECT_TRUE(keepsSchema(written.out, "eval")) << written.err;
    EXPECT_EQ(Json::parse(all.out)["pairs"], 2);
    EXPECT_NEAR(Json::parse(all.out)["values"][5].get<double>(), .3 / M_PI, 1e-15);
    EXPECT_EQ(Json::parse(written.out)["output"], path("values.csv"));
    const Answer text = run("eval lambert-transmission --wi 30,0 --wo 150,180");
    EXPECT_NE(text.err.find("transmission-front, wo below the surface"), std::string::npos);

    refuses("eval " + glass + " --wi 30,0 --wo 20,0", 3, "above the surface");
    refuses("eval lambert --wi 30,0 --wo 120,0", 2, "theta from 0 to 90");
    EXPECT_FALSE(Json::parse(run("eval lambert --wi 1,0 --wo 2,0 --json").out).contains("side"));
}

TEST_F(TransmissionCommands, EvalOfPairsRefusesADirectionAbove) {
    write("pairs.csv", "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z\n0,0,1,0,0,-1\n0,0,1,0,0,1\n");
    refuses("eval " + glass + " --pairs " + path("pairs.csv"), 3, "pair 2: wo_z = 1");
    write("pairs.csv",
          "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z\n0,0,1,0,0,-1\n0.6,0,0.8,-0.4,0,-0.916515138991168\n");
    const Answer answer = run("eval " + glass + " --pairs " + path("pairs.csv"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_EQ(std::count(answer.out.begin(), answer.out.end(), '\n'), 3);
}

TEST_F(TransmissionCommands, CoefficientsOfATransmissionStayOne) {
    const std::string file = path("glass.json");
    const Answer projected = run("project " + glass + " --order 12 -o " + file + " --json");
    ASSERT_EQ(projected.code, 0) << projected.err;
    EXPECT_TRUE(keepsSchema(projected.out, "project"));
    const Json answer = Json::parse(projected.out);
    EXPECT_EQ(answer["side"], "transmission-front");
    ASSERT_TRUE(answer.contains("picture"));
    EXPECT_GT(answer["accuracy"].get<double>(), .8);

    const Answer info = run("info " + file + " --json");
    ASSERT_EQ(info.code, 0) << info.err;
    EXPECT_TRUE(keepsSchema(info.out, "info"));
    EXPECT_EQ(Json::parse(info.out)["side"], "transmission-front");
    const std::string text = run("info " + glass).out;
    EXPECT_NE(text.find("largest transmittance"), std::string::npos);
    EXPECT_EQ(text.find("reciprocity defect"), std::string::npos);

    const Answer value = run("eval " + file + " --wi 0,0 --wo 180,0 --json");
    ASSERT_EQ(value.code, 0) << value.err;
    refuses("eval " + file + " --wi 0,0 --wo 0,0", 3, "above the surface");
    const Answer compared = run("compare " + glass + " " + file);
    EXPECT_EQ(compared.code, 0) << compared.err;
    EXPECT_EQ(compared.out.find("reciprocity"), std::string::npos);
    EXPECT_NE(compared.out.find("transmission-front: drawn as if it were reflected"),
              std::string::npos);
    const Answer document = run("compare " + glass + " " + file + " --json");
    EXPECT_TRUE(keepsSchema(document.out, "compare"));
    EXPECT_EQ(Json::parse(document.out)["side"], "transmission-front");
    EXPECT_EQ(Json::parse(document.out)["picture"], answer["picture"]);
    refuses("compare " + glass + " " + file + " -o " + path("page"), 2,
            "a page with its lit spheres takes reflections");
    refuses("compare " + glass + " " + file + " --metrics reciprocity", 2, "not exchanged");
    EXPECT_EQ(run("report " + glass + " --json --bases hsh --max-order 4 --outgoing 4").code, 0);
    refuses("project " + glass + " --form basis --reciprocal -o " + path("b.json"), 2,
            "directions are not exchanged");
}

TEST_F(TransmissionCommands, RepairsSpeakOfTransmittance) {
    const auto suggested = [&](const std::string& model, const std::string& key) {
        const std::string spec = model + ":" + key + "=.8 + " + model + ":" + key + "=.5";
        return run("info '" + spec + "'").out;
    };
    EXPECT_NE(suggested("lambert-transmission", "kt").find("the largest transmittance is 1.3000"),
              std::string::npos);
    EXPECT_NE(suggested("lambert", "kd").find("the largest reflectance is 1.3000"),
              std::string::npos);
}

TEST_F(TransmissionCommands, PanesWithoutLightBehindThemSaySo) {
    const std::string pane = "render lambert-transmission:kt=.5 --size 32 --force -o " +
                             path("p.png") + " --light ",
                      front = "sun:elevation=40,irradiance=3", said = "of the pane is black";
    for (const char* by : {" --by integration", " --by coefficients --outgoing 8"}) {
        const Answer dark = run(pane + front + by);
        EXPECT_EQ(dark.code, 0) << dark.err;
        EXPECT_NE(dark.err.find(said), std::string::npos) << by << dark.err;
        // The view that the message names has the light behind the pane.
        ASSERT_NE(dark.err.find("--view 105,180"), std::string::npos) << dark.err;
        EXPECT_EQ(run(pane + front + " --view 105,180" + by).err.find(said), std::string::npos);
    }
    EXPECT_EQ(run(pane + "uniform:radiance=1").err.find(said), std::string::npos);
    EXPECT_EQ(run("render lambert --size 32 --by integration -o " + path("l.png") +
                  " --light sun:elevation=-80,irradiance=3")
                  .err.find(said),
              std::string::npos);
}

TEST_F(TransmissionCommands, PictureErrorsAreThoseOfTheMirroredReflection) {
    const auto picture = [&](const std::string& model, const std::string& key) {
        const Answer answer = run("compare " + model + ":" + key + "=.2/.5/.7 " + model + ":" +
                                  key + "=.3/.5/.6 --outgoing 4 --json");
        EXPECT_EQ(answer.code, 0) << answer.err;
        return Json::parse(answer.out)["picture"];
    };
    const Json through = picture("lambert-transmission", "kt");
    EXPECT_EQ(through, picture("lambert", "kd"));
    // The red is up by a half, and the blue down by a seventh.
    EXPECT_NEAR(through["albedo"][0].get<double>(), .5, 1e-6);
    EXPECT_NEAR(through["albedo"][2].get<double>(), -1. / 7, 1e-6);
}

TEST_F(TransmissionCommands, TransmissionIsRenderedAsPanesAndExportedWithItsDirection) {
    const std::string file = path("glass.json");
    ASSERT_EQ(run("project " + glass + " --order 6 --outgoing 16 -o " + file).code, 0);
    const std::string light = " --size 16 --light uniform:radiance=1 -o ";
    const Answer pane = run("render " + glass + light + path("pane.png"));
    EXPECT_EQ(pane.code, 0) << pane.err;
    refuses("render " + glass + " --size 16 -o " + path("s.png"), 2, "a sky or a picture");
    refuses("render " + glass + " lambert" + light + path("s.png"), 2, "a sheet of each");
    const Answer exported = run("export " + file + " -o " + path("out") + " --target glsl");
    ASSERT_EQ(exported.code, 0) << exported.err;
    bool said = false;
    for (const auto& entry : std::filesystem::directory_iterator(path("out")))
        said =
            said || read(entry.path()).find("(x, y, z) stands for (x, y, -z)") != std::string::npos;
    EXPECT_TRUE(said);
    refuses("export " + file + " -o " + path("page") + " --target viewer", 2,
            "draws reflecting surfaces");
}

TEST_F(TransmissionCommands, AnXmlFileKeepsAllItsBlocks) {
    const std::string front = path("front.xml"), copy = path("copy.xml");
    ASSERT_EQ(run("convert " + glass + " " + front + " --to bsdf-klems:evaluations=1e5").code, 0);
    EXPECT_NE(read(front).find("Transmission Front"), std::string::npos);
    EXPECT_NE(read(front).find("BTDF"), std::string::npos);
    const Answer whole = run("convert " + front + " " + copy + " --to bsdf-klems:side=all");
    ASSERT_EQ(whole.code, 0) << whole.err;
    const Answer compared = run("compare " + front + " " + copy + " --outgoing 4x4 --json");
    ASSERT_EQ(compared.code, 0) << compared.err;
    EXPECT_LE(Json::parse(compared.out)["metrics"][0]["value"].get<double>(), 1e-6);
    refuses("convert lambert " + path("a.xml") + " --to bsdf-klems:side=all", 2,
            "side=all writes the blocks of a BSDF XML file");
    refuses("convert " + glass + " " + path("a.binary"), 2, "merl takes reflections");
    refuses("convert " + glass + " " + path("a.xml") + " --to bsdf-klems:side=front", 2,
            "is a transmission, which side=front is not");
}

TEST_F(TransmissionCommands, OtherCommandsRefuseATransmission) {
    const std::string out = " -o " + path("x.json");
    write("t.astm", "VARS theta_i,phi_i,theta_s,phi_s,f\n0.1,0,2.9,3,1\n0.4,0,2.5,3,1\n");
    const std::vector<std::string> commands = {"fit " + glass + " --model ggx" + out,
                                               "fit ggx:alpha=0.3 --model rough-glass" + out,
                                               "fit " + path("t.astm") + " --model lambert" + out,
                                               "choose " + glass + out,
                                               "tradeoff " + glass + out,
                                               "gaussians " + glass + out,
                                               "sample " + glass + " --count 4"};
    for (const std::string& command : commands) {
        const Answer answer = run(command);
        EXPECT_EQ(answer.code, 2) << command << answer.err;
        EXPECT_NE(answer.err.find("transmission"), std::string::npos) << command << answer.err;
    }
    refuses("compare ggx:alpha=0.2 " + glass, 2, "both have to be of the same side");
    refuses("compare " + glass + " lambert-transmission:side=transmission-back", 2, "same side");
}

}  // namespace
