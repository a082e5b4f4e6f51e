#include "command_table.h"

namespace hshfit::cli {

void addList(CLI::App& command, Globals& globals);
void addInfo(CLI::App& command, Globals& globals);
void addEval(CLI::App& command, Globals& globals);
void addProject(CLI::App& command, Globals& globals);
void addReport(CLI::App& command, Globals& globals);
void addCompare(CLI::App& command, Globals& globals);
void addConvert(CLI::App& command, Globals& globals);
void addExport(CLI::App& command, Globals& globals);
void addFit(CLI::App& command, Globals& globals);
void addPlot(CLI::App& command, Globals& globals);
void addRender(CLI::App& command, Globals& globals);
void addLtc(CLI::App& command, Globals& globals);
void addGaussians(CLI::App& command, Globals& globals);
void addTradeoff(CLI::App& command, Globals& globals);
void addIlluminate(CLI::App& command, Globals& globals);
void addPlan(CLI::App& command, Globals& globals);
void addChoose(CLI::App& command, Globals& globals);
void addStress(CLI::App& command, Globals& globals);
void addImport(CLI::App& command, Globals& globals);
void addMatrix(CLI::App& command, Globals& globals);
void addRotate(CLI::App& command, Globals& globals);
void addLight(CLI::App& command, Globals& globals);
void addIrradiance(CLI::App& command, Globals& globals);
void addSample(CLI::App& command, Globals& globals);
void addTransfer(CLI::App& command, Globals& globals);
void addBatch(CLI::App& command, Globals& globals);
void addSvbrdf(CLI::App& command, Globals& globals);
void addLibrary(CLI::App& command, Globals& globals);
void addHelp(CLI::App& command, Globals& globals);
void addCompletion(CLI::App& command, Globals& globals);
void addManual(CLI::App& command, Globals& globals);

namespace {

constexpr const char* inspection = "Inspection";
constexpr const char* coefficients = "Coefficients";
constexpr const char* files = "Files";
constexpr const char* fits = "Fits";
constexpr const char* studies = "Studies";
constexpr const char* lighting = "Light";
constexpr const char* program = "The program";

/// A row of a wing: without its functions where that is not built.
constexpr Command inWing(Wing wing, Command row) {
    row.wing = wing;
    if (!isBuilt(wing)) row.add = nullptr, row.options = nullptr;
    return row;
}

constexpr Command table[] = {
    {.name = "list",
     .group = inspection,
     .help =
         "The catalogs: models, formats (read), writers, lights, bases, metrics, targets, presets",
     .file = "list.cpp",
     .example = "hshfit list presets acrylic",
     .add = addList,
     .options = listRows},
    {.name = "info",
     .group = inspection,
     .help = "What a BRDF, a light or a coefficient file is, and how healthy: channels, symmetry, "
             "sampling, invalid values, coverage, reciprocity, albedo, repairs; of a light mean, "
             "peak, range",
     .file = "info.cpp",
     .example = "hshfit info ggx:alpha=.2,F0=.9",
     .add = addInfo,
     .options = infoRows},
    {.name = "eval",
     .group = inspection,
     .help = "Values of a BRDF or of coefficients",
     .file = "eval.cpp",
     .example = "hshfit eval ward:ax=.2,ay=.5 --wi 30,0 --wo 45,180",
     .add = addEval,
     .options = evalRows},
    {.name = "project",
     .group = coefficients,
     .help = "Coefficients of a BRDF, per outgoing direction, to a file",
     .file = "project.cpp",
     .example = "hshfit project ward:ax=.2,ay=.5 -o ward.json --basis hsh --order 7 --cosine",
     .add = addProject,
     .options = projectRows},
    {.name = "report",
     .group = coefficients,
     .help = "Accuracy against number of coefficients, for every basis",
     .file = "report.cpp",
     .example = "hshfit report phong:exponent=22 ward:ax=.2,ay=.5 -o report --cosine",
     .add = addReport,
     .options = reportRows},
    {.name = "compare",
     .group = inspection,
     .help = "Error metrics between two BRDFs, or a BRDF and its coefficients",
     .file = "compare.cpp",
     .example = "hshfit compare ward:ax=.2,ay=.5 ward.json",
     .add = addCompare,
     .options = compareRows},
    {.name = "convert",
     .group = files,
     .help = "Write a BRDF in another format",
     .file = "convert.cpp",
     .example = "hshfit convert ggx:alpha=.3,F0=.9 ggx.binary --report-loss",
     .add = addConvert,
     .options = convertRows},
    {.name = "export",
     .group = files,
     .help = "Coefficients as textures, shaders and a viewer, with the error that they have",
     .file = "export.cpp",
     .example = "hshfit export ward.json -o out/ward --target three,viewer",
     .add = addExport,
     .options = exportRows},
    {.name = "fit",
     .group = fits,
     .help = "Fit analytic models to data",
     .file = "fit.cpp",
     .example = "hshfit fit ggx:alpha=.2,F0=.3,kd=.1 --model ward -o fit.json",
     .add = addFit,
     .options = fitRows},
    {.name = "render",
     .group = inspection,
     .help = "Spheres and meshes under any light, by integration and by coefficients, side by side",
     .file = "render.cpp",
     .example = "hshfit render lambert ggx:alpha=.2 -o spheres.png",
     .add = addRender,
     .options = renderRows},
    {.name = "plot",
     .group = inspection,
     .help = "The functions of a basis as a figure of lobes",
     .file = "plot.cpp",
     .example = "hshfit plot hsh -o hsh.png",
     .add = addPlot,
     .options = plotRows},
    {.name = "ltc",
     .group = fits,
     .help =
         "Linearly transformed cosines of a model over roughness and elevation, for area lights",
     .file = "ltc.cpp",
     .example = "hshfit ltc ggx -o ggx.dds -o ggx.json",
     .add = addLtc,
     .options = ltcRows},
    {.name = "gaussians",
     .group = fits,
     .help = "Spherical or anisotropic Gaussians of a BRDF, per elevation; the file is a BRDF too",
     .file = "gaussians.cpp",
     .example = "hshfit gaussians ggx:alpha=.2 --lobes 3 --kind asg -o ggx.json",
     .add = addGaussians,
     .options = gaussianRows},
    inWing(Wing::studies,
           {.name = "tradeoff",
            .group = studies,
            .help = "Size, speed and error of every form of a coefficient file",
            .file = "tradeoff.cpp",
            .example = "hshfit tradeoff ggx:alpha=.3 -o trade --bases hsh --max-bytes 4096",
            .add = addTradeoff,
            .options = tradeoffRows}),
    inWing(
        Wing::scenes,
        {.name = "plan",
         .group = studies,
         .help = "The least that a scene needs: the cheapest coefficient file for each material, "
                 "checked in the scene's own light",
         .file = "plan.cpp",
         .example = "hshfit plan examples/scenes/car_paint.json -o plan",
         .add = addPlan,
         .options = planRows}),
    inWing(Wing::studies,
           {.name = "choose",
            .group = studies,
            .help = "The smallest faithful material for a renderer: the model itself, lobes, glTF, "
                    "OpenPBR or coefficients, with what each loses to the eye",
            .file = "choose.cpp",
            .example = "hshfit choose ggx:alpha=.3,F0=.9/.6/.3 --for gltf -o choose",
            .add = addChoose,
            .options = chooseRows}),
    inWing(
        Wing::studies,
        {.name = "stress",
         .group = studies,
         .help = "Where the program's numbers stop being good: bases by degree, lobes by width and "
                 "elevation",
         .file = "stress.cpp",
         .example = "hshfit stress --max-order 300 --trials 20 -o out/stress",
         .add = addStress,
         .options = stressRows}),
    {.name = "import",
     .group = files,
     .help = "Coefficients back from a file that hshfit export wrote",
     .file = "import.cpp",
     .example = "hshfit import out/ward/ward.hsh.json -o ward_again.json",
     .add = addImport,
     .options = importRows},
    {.name = "rotate",
     .group = coefficients,
     .help = "Coefficients of a rotated function, with the energy that left the hemisphere",
     .file = "rotate.cpp",
     .example = "hshfit rotate ward.json -o turned.json --euler 0,30,0",
     .add = addRotate,
     .options = rotateRows},
    {.name = "matrix",
     .group = coefficients,
     .help = "The matrix of a change of basis or of a rotation",
     .file = "matrix.cpp",
     .example = "hshfit matrix sh hsh --order 3",
     .add = addMatrix,
     .options = matrixRows},
    {.name = "light",
     .group = lighting,
     .help = "Coefficients of light from all around or above a surface, and the bands it needs",
     .file = "light.cpp",
     .example = "hshfit light sky:type=12,elevation=40,radiance=1 -o sky.json --order 10",
     .add = addLight,
     .options = lightRows},
    {.name = "irradiance",
     .group = lighting,
     .help =
         "The nine coefficients that engines take, in each engine's convention, with their error",
     .file = "irradiance.cpp",
     .example = "hshfit irradiance sky:type=12,elevation=40,radiance=1 --convention three",
     .add = addIrradiance,
     .options = irradianceRows},
    inWing(Wing::scenes,
           {.name = "illuminate",
            .group = inspection,
            .help =
                "Pictures of a scene with global illumination, by path tracing or a radiance cache",
            .file = "illuminate.cpp",
            .example = "hshfit illuminate examples/scenes/box.json -o box --samples 16",
            .add = addIlluminate,
            .options = illuminateRows}),
    inWing(
        Wing::scenes,
        {.name = "transfer",
         .group = lighting,
         .help =
             "Precomputed transfer of a scene: how light from all around reaches each vertex, with "
             "shadows and interreflection",
         .file = "transfer.cpp",
         .example = "hshfit transfer examples/scenes/ball_and_wall.json -o ball --rays 400",
         .add = addTransfer,
         .options = transferRows}),
    {.name = "sample",
     .group = inspection,
     .help = "Incident directions in proportion to f cos(theta_i), and their efficiency",
     .file = "sample.cpp",
     .example = "hshfit sample ggx:alpha=.2 --outgoing 45,0 --count 100 -o samples.csv",
     .add = addSample,
     .options = sampleRows},
    inWing(Wing::batches, {.name = "batch",
                           .group = studies,
                           .help = "Many materials: the commands of a manifest, in processes and "
                                   "on machines side by side",
                           .file = "batch.cpp",
                           .example = "hshfit batch examples/batch/materials.jsonl -o batch",
                           .add = addBatch,
                           .options = batchRows}),
    inWing(Wing::maps,
           {.name = "svbrdf",
            .group = studies,
            .help = "Textures of materials: parameter maps as coefficient textures with mip levels",
            .file = "svbrdf.cpp",
            .example = "hshfit svbrdf examples/maps/coin.json -o coin --form low-rank",
            .add = addSvbrdf,
            .options = svbrdfRows}),
    inWing(
        Wing::library,
        {.name = "library",
         .group = fits,
         .help = "Many materials in a basis learned from them: a few bytes each, nearest ones, and "
                 "materials from few measurements",
         .file = "library.cpp",
         .example = "hshfit library learn ggx:alpha=.2,F0=.9/.6/.3 ggx:alpha=.3,F0=.04 "
                    "lambert:kd=.3/.2/.1 -o studio.library",
         .add = addLibrary,
         .options = libraryRows}),
    {.name = "help",
     .group = program,
     .help = "Commands by group and topics; the options of one command; one topic",
     .file = "help.cpp",
     .example = "hshfit help specifications",
     .add = addHelp,
     .options = helpRows},
    {.name = "completion",
     .group = program,
     .help = "A script that completes commands, options, models, parameters, presets and other "
             "names in a shell",
     .file = "completion.cpp",
     .example = "hshfit completion bash -o hshfit.bash",
     .add = addCompletion,
     .options = completionRows},
    {.name = "manual",
     .group = program,
     .help = "The manual: a page for man of the program, of every command and of every topic",
     .file = "manual.cpp",
     .example = "hshfit manual -o man",
     .add = addManual,
     .options = manualRows},
};

}  // namespace

std::span<const Command> commands() {
    return table;
}

}  // namespace hshfit::cli
