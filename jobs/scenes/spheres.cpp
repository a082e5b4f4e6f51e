#include "spheres.h"

#include "render.h"

#include <jobs/common/inputs.h>
#include <jobs/source/source.h>

#include <hshfit/brdf/transmission.h>
#include <hshfit/error.h>
#include <hshfit/pictures/sphere_picture.h>

#include <fmt/format.h>

#include <map>

namespace hshfit::jobs {

SphereSheet render(const std::vector<std::string>& sources, const std::string& output,
                   const SphereSheetOptions& options, const Listener& listener) {
    checkSpheresPath(output);
    SphereSheet result;
    std::vector<SpherePicture> pictures;
    std::map<std::string, std::string> attributes;
    for (const std::string& source : expandInputs(sources, Members::both)) {
        const auto brdf = openSource(source, false, Sides::either);
        if (transmits(*brdf))
            throw UsageError(
                fmt::format("{}: is a transmission, and point lights about the viewer leave a pane "
                            "dark; expected a sky or a picture as light",
                            brdf->name()));
        const std::string name = shownName(source, *brdf);
        remarkContents(name, *brdf, listener);
        const SpherePicture& picture =
            pictures.emplace_back(renderSphere(*brdf, {.rig = options.rig,
                                                       .size = options.size,
                                                       .samples = options.samples,
                                                       .sharpened = true,
                                                       .progress = listener.part(name)}));
        brdf->checkIntact();
        const std::size_t column = result.spheres.size() * static_cast<std::size_t>(options.size);
        result.spheres.push_back({name, picture.colours, column, picture.notFinite});
        attributes[fmt::format("hshfit:sphere{}", pictures.size())] = name;
        if (picture.notFinite > 0) {
            listener.say(fmt::format("{}: {} values that are not finite were left out", name,
                                     picture.notFinite));
        }
    }
    result.stops = options.exposure ? *options.exposure : automaticExposure(pictures);
    writeSpheres(pictures, result.stops, output, attributes);
    return result;
}

}  // namespace hshfit::jobs
