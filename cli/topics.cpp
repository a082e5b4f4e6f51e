#include "topics.h"

#include <hshfit/accuracy/metrics.h>
#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/gpu/containers/targets.h>
#include <hshfit/light/catalog.h>

#include <brdfs/catalog.h>
#include <brdfs/catalog/metal_spec.h>
#include <brdfs/catalog/preset.h>
#include <brdfs/composed/sum.h>
#include <brdfs/fit/dispersion_law.h>
#include <brdfs/fit/loss.h>
#include <brdfs/presets/metals.h>
#include <brdfs/presets/preset_collection.h>
#include <brdfs/repair.h>

#include <fmt/format.h>

namespace hshfit::cli {
namespace {

/// Rows of a table of the program, by name and help.
template <class Rows>
void addRows(Page& page, const Rows& rows) {
    for (const auto& row : rows) addRow(page, std::string(row.name), std::string(row.help));
}

Page specifications() {
    Page page;
    addHeading(page, "A BRDF is one of");
    addRow(page, "MODEL", "an analytic model with its defaults: lambert");
    addRow(page, "MODEL:KEY=VALUE,…",
           "with parameters; colours are one number or r/g/b: ggx:alpha=.2,F0=1/.7/.3");
    addRow(page, "MODEL:…,metal=NAME", std::string(brdfs::metalHelp));
    addRow(page, "PATH", "a measured file, recognised by its content; a preset; a fit");
    addRow(page, "PATH:KEY=VALUE,…", "a measured file with options of its format");
    addRow(page, "FIT.json:nm=WAVELENGTHS",
           "a fit with laws over the wavelength (fit --dispersion), at these: nm=450/550 or "
           "nm=400:700:10");
    addRow(page, "preset:NAME", "published parameters: preset:ngan-ward/blue-acrylic");
    addRow(page, "SPEC + SPEC", std::string(brdfs::sumHelp));
    addRow(page, "rgb:SPEC", "wavelengths as linear Rec. 709");
    addRow(page, "grey:SPEC", "the mean of the channels; grey=1/0/0:SPEC weighs them");
    addHeading(page, "Models");
    addRows(page, brdfs::models());
    addParagraph(page,
                 "`hshfit list models` has their parameters, ranges and sources. Words of a shell "
                 "end at spaces: a specification with spaces stands in quotes.");
    return page;
}

Page dispersions() {
    Page page;
    addHeading(page, "Laws of fit --dispersion PARAMETER=LAW[:N][,…]");
    addRows(page, brdfs::dispersionLaws());
    addParagraph(page,
                 "Shapes (roughness, exponents, indices) without a law are shared, scales and "
                 "albedos free. cauchy and sellmeier are for ior.");
    addHeading(page, "Metals, in place of ior and k: metal=NAME");
    addRows(page, brdfs::metals());
    addHeading(page, "Example");
    addCommand(page,
               "hshfit fit ggx:alpha=.3,metal=gold,nm=450:650:25 --model ggx:fresnel=conductor "
               "--dispersion ior=poly:4,k=poly:4,ks=shared --loss cosine");
    return page;
}

Page formats() {
    Page page;
    addHeading(page, "Read");
    addRows(page, brdfs::formats());
    addHeading(page, "Written by convert");
    addRows(page, brdfs::writers());
    addHeading(page, "Repairs by convert --repair");
    addRows(page, brdfs::repairs());
    addParagraph(page, "`hshfit list formats` and `hshfit list writers` have their options.");
    return page;
}

Page presets() {
    Page page;
    addHeading(page, "Presets, preset:NAME");
    addRows(page, brdfs::presets());
    addHeading(page, "Collections, preset:COLLECTION/MATERIAL");
    for (std::size_t k = 0; k < brdfs::presetCollections().size(); ++k)
        addRow(page, std::string(brdfs::presetCollections()[k].name),
               fmt::format("{} ({} materials)", brdfs::presetCollection(k).help,
                           brdfs::presetCollection(k).materials.size()));
    addHeading(page, "To find a material by a part of its name");
    addCommand(page, "hshfit list presets acrylic");
    return page;
}

Page lights() {
    Page page;
    addHeading(page, "A light is one of");
    addRows(page, lightKinds());
    for (const LightKind* kind : {&studioKind(), &pictureKind(), &coefficientsKind()})
        addRow(page, std::string(kind->name), std::string(kind->help));
    addRow(page, "LIGHT+LIGHT", std::string(lightSumHelp));
    addHeading(page, "Examples");
    for (const LightKind& kind : lightKinds()) addCommand(page, std::string(kind.example));
    addCommand(page, std::string(pictureKind().example));
    addParagraph(page,
                 "Elevations are above the horizon, azimuths from +x towards +y, in degrees; "
                 "+z is up. `hshfit list lights` has all parameters.");
    return page;
}

Page basesPage() {
    Page page;
    addHeading(page, "Bases");
    addRows(page, bases::catalog());
    addParagraph(page,
                 "Order n means the bands l = 0 … n-1, n^2 coefficients in the order "
                 "l (l + 1) + m. `hshfit plot BASIS -o FILE` draws them.");
    return page;
}

Page metrics() {
    Page page;
    addHeading(page, "Error metrics of compare");
    addRows(page, metricCatalog());
    return page;
}

Page targets() {
    Page page;
    addHeading(page, "Targets of export");
    for (const gpu::Target& target : gpu::targets()) addRow(page, target.name, target.summary);
    return page;
}

Page losses() {
    Page page;
    addHeading(page, "Losses of fit");
    for (const brdfs::Loss& loss : brdfs::losses()) {
        std::string text = "squares of the differences of " + std::string(loss.help);
        if (!loss.source.empty()) text += fmt::format(" ({})", loss.source);
        addRow(page, std::string(loss.name), text);
    }
    addParagraph(page,
                 "f is the BRDF and c = cos(theta_i). `--robust huber` and `--robust cauchy` "
                 "damp outliers.");
    return page;
}

Page directions() {
    Page page;
    addHeading(page, "One direction");
    addRow(page, "THETA,PHI",
           "polar angle from the normal and azimuth from the tangent +x, in "
           "degrees: 45,0");
    addHeading(page, "Outgoing directions of project, report, compare and others");
    addRow(page, "WxH", "a parabolic map of the hemisphere, W times H cells: 32x32");
    addRow(page, "N", "elevations, for an isotropic BRDF: 32");
    addRow(page, "THETA,PHI", "this one alone");
    addParagraph(page,
                 "wi is the incoming direction and wo the outgoing one; both point away from "
                 "the surface. f is in 1/sr and has no cosine in it; with --cosine it is "
                 "f cos(theta_i).");
    return page;
}

Page files() {
    Page page;
    addHeading(page, "Files that commands hand to each other");
    addRow(page, ".json",
           "coefficients of a BRDF (project, import, rotate), in any form; of light "
           "(light, rotate); a fit or preset (fit); Gaussians (gaussians); each is "
           "recognised by its content");
    addRow(page, ".exr", "coefficients of a BRDF as a picture with attributes");
    addRow(page, "NAME.hsh.json", "an export, which import, info, eval and compare read back");
    addRow(page, ".csv",
           "pairs of directions for eval, with the columns wi_x, wi_y, wi_z, wo_x, "
           "wo_y, wo_z, or theta_i, phi_i, theta_o, phi_o in degrees; samples");
    addHeading(page, "How they are written");
    addParagraph(page,
                 "A file appears under its name once it is complete. Files of one command "
                 "appear together or not at all. A file that exists is kept if it was made from "
                 "the same input, options and version, and refused otherwise; --force "
                 "replaces it.");
    return page;
}

Page exitCodes() {
    const std::pair<ExitCode, const char*> rows[] = {
        {ExitCode::done, "done"},
        {ExitCode::usage, "a command line or a specification that cannot be understood"},
        {ExitCode::input, "an input that cannot be read or whose content is invalid"},
        {ExitCode::numeric,
         "numbers that do not exist, such as an energy that diverges, or did "
         "not converge"},
        {ExitCode::output, "an output that could not be written; no part of it is left"}};
    Page page;
    addHeading(page, "Exit codes");
    for (const auto& [code, text] : rows)
        addRow(page, std::to_string(static_cast<int>(code)), text);
    addParagraph(page,
                 "An error is one line on standard error: the fault, its place, and valid "
                 "values. Of several inputs that fail, the code is 3, or 4 if all failures "
                 "are numerical.");
    return page;
}

Page environment() {
    Page page;
    addHeading(page, "Environment variables");
    addRow(page, "NO_COLOR", "if not empty, no bold and coloured text");
    addRow(page, "COLUMNS", "the width of help, 40 to 100; without it that of the terminal, or 80");
    return page;
}

constexpr Topic table[] = {
    {"specifications", "how a BRDF is named: models, files, presets, sums", specifications},
    {"lights", "how a light is named: suns, skies, panels, pictures, sums", lights},
    {"directions", "angles, and sets of outgoing directions", directions},
    {"bases", "the bases of project and report", basesPage},
    {"formats", "measured files that are read and written, and repairs", formats},
    {"presets", "published materials", presets},
    {"metrics", "the distances that compare measures", metrics},
    {"losses", "the distances that fit makes small", losses},
    {"dispersions", "laws over the wavelength of fit, and metals", dispersions},
    {"targets", "textures, shaders and pages that export writes", targets},
    {"files", "files of the program's own", files},
    {"exit-codes", "the numbers that commands end with", exitCodes},
    {"environment", "variables that the program reads", environment},
};

}  // namespace

std::span<const Topic> topics() {
    return table;
}

}  // namespace hshfit::cli
