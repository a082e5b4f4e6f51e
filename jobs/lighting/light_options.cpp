#include "irradiance.h"
#include "light.h"

#include <jobs/common/number_text.h>
#include <jobs/common/option_words.h>

namespace hshfit::jobs {
namespace {

using options::at;

std::vector<Word> irradianceWindows() {
    return {{"none"}, {"hann"}, {"lanczos"}, {"least-negative"}};
}

std::vector<Word> conventionWords() {
    std::vector<Word> words;
    for (const Convention& convention : conventions())
        words.push_back({std::string(convention.name), std::string(convention.engine)});
    return withAll(words);
}

Orientation normalIn(const std::string& text) {
    const Direction normal = anglesIn(text, "LightOptions::normal", 180).direction();
    return {.theta = polarAngle(normal), .phi = azimuth(normal), .turn = 0};
}

constexpr OptionRow lightRows[] = {
    OptionRow{"normal",
              options::spelled<normalIn, options::untold<Orientation>, &LightOptions::normal>,
              "THETA,PHI in degrees: the hemisphere about it, in its own frame (default: the whole "
              "sphere)"}
        .takes({.syntax = Syntax::numbers}),
    OptionRow{"basis", at<&LightOptions::basis>, "sh; with --normal any of hshfit list bases"}
        .takes({.words = basisWords}),
    OptionRow{"order", at<&LightOptions::order>, "Number of bands: l = 0 .. order-1"}.within(
        bounds::lightOrder),
    OptionRow{"wavelets", at<&LightOptions::wavelets>,
              "A curve of SOHO wavelets too: the best n^2 terms of each channel"},
    OptionRow{"split-sun", at<&LightOptions::splitSun>,
              "Split one picture into a sun: and NAME_rest.exr beside NAME.json, whose sum is the "
              "picture; exit code 3 where it has no sun"},
    OptionRow{"condon-shortley", at<&LightOptions::condonShortley>,
              "Give functions of odd m the Condon-Shortley sign"},
    OptionRow{"tolerance", at<&LightOptions::tolerance>,
              "Relative error that quadrature is refined to, where light has no closed form"}
        .within(bounds::tolerance),
};

constexpr OptionRow irradianceRows[] = {
    OptionRow{"convention", at<&IrradianceOptions::convention>,
              "three, unity, unity-csharp, filament, godot, unreal, babylon, gltf, playcanvas, "
              "cesium, geomerics or all"}
        .takes({.words = conventionWords}),
    OptionRow{"for", at<&IrradianceOptions::engine>,
              "One of these, with the light turned as its own import of panoramas does"}
        .takes({.words = conventionWords})
        .inPython("engine")
        .notWith("convention"),
    OptionRow{"order", at<&IrradianceOptions::order>, "Bands of the irradiance"}.within(
        bounds::irradianceOrder),
    OptionRow{"window", at<&IrradianceOptions::window>,
              "Against ringing: none, hann, lanczos or least-negative"}
        .takes({.words = irradianceWindows, .complete = true}),
    OptionRow{"normals", at<&IrradianceOptions::normals>, "Normals at which the error is taken"}
        .within(bounds::normals),
    OptionRow{"by-normal", at<&IrradianceOptions::byNormal>,
              "CSV of direct and approximate irradiance at each of them"}
        .takes({.files = Files::written, .dash = ".csv"}),
};

}  // namespace

OptionRows<LightOptions> lightOptions() {
    return {lightRows};
}

OptionRows<IrradianceOptions> irradianceOptions() {
    return {irradianceRows};
}

}  // namespace hshfit::jobs
