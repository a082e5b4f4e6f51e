#include "arrays.h"
#include "job_options.h"
#include "watched.h"

#include <hshfit/choice/choice_files.h>
#include <hshfit/tradeoff/tradeoff_files.h>

#include <jobs/fits/gaussians.h>
#include <jobs/fits/ltc.h>
#include <jobs/studies/choose.h>
#include <jobs/studies/stress.h>
#include <jobs/studies/tradeoff.h>

#include <pybind11/stl.h>
#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace hshfit::python {
namespace {

/// One path or a sequence of them.
std::string folderOf(const py::object& folder) {
    return folder.is_none() ? std::string() : pathOf(folder, "folder");
}

Options optionsOf(jobs::TradeoffOptions& options) {
    return joined({boundOptions(jobs::sweepOptions(), options.sweep),
                   boundOptions(jobs::tradeoffOptions(), options)});
}

py::object traded(const py::object& specs, const py::object& folder, const py::kwargs& keywords) {
    jobs::TradeoffOptions options;
    const py::object progress = optionsFrom(keywords, optionsOf(options));
    const std::vector<std::string> sources = pathsOf(specs, "specs");
    const std::string output = folderOf(folder);
    nlohmann::ordered_json answer;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        const auto measured = jobs::measureTradeoffs(sources, output, options, listener);
        for (const jobs::InputFailure& failure : measured.failures)
            listener.say(failure.spec + ": " + failure.reason);
        answer = nlohmann::ordered_json::parse(tradeoff::tradeoffJson(measured.trades, true));
    });
    return fromJson(answer);
}

py::object chosen(const std::string& spec, const py::object& folder, const py::kwargs& keywords) {
    jobs::ChooseOptions options;
    const py::object progress = optionsFrom(keywords, boundOptions(jobs::chooseOptions(), options));
    const std::string output = folderOf(folder);
    std::string answer;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        answer = choice::choiceJson(jobs::choose(spec, output, options, listener));
    });
    return fromJson(nlohmann::ordered_json::parse(answer));
}

py::object cosines(const std::string& model, const py::object& files, const py::kwargs& keywords) {
    brdfs::LtcTableOptions options;
    const py::object progress = optionsFrom(keywords, boundOptions(jobs::ltcOptions(), options));
    const std::vector<std::string> outputs = pathsOf(files, "files");
    nlohmann::ordered_json answer;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        answer = jobs::ltcJson(jobs::fitLtc(model, outputs, options, listener));
    });
    return fromJson(answer);
}

py::object mixed(const std::string& spec, const py::object& file, const py::kwargs& keywords) {
    jobs::GaussianOptions options;
    const py::object progress =
        optionsFrom(keywords, boundOptions(jobs::gaussianOptions(), options));
    const std::string output = pathOf(file, "file");
    nlohmann::ordered_json answer;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        answer = jobs::gaussiansJson(jobs::fitGaussians(spec, output, options, listener), output,
                                     options);
    });
    return fromJson(answer);
}

py::object stressed(const py::object& specs, const py::object& folder, const py::kwargs& keywords) {
    jobs::StressOptions options;
    const py::object progress = optionsFrom(keywords, boundOptions(jobs::stressOptions(), options));
    for (const py::handle spec : specs) options.lobes.push_back(spec.cast<std::string>());
    const std::string output = folderOf(folder);
    std::string answer;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        answer = stability::stressJson(jobs::stress(output, options, listener));
    });
    return fromJson(nlohmann::ordered_json::parse(answer));
}

/// Studies that answer with the document of their command.
void bindAnswers(py::module_& module) {
    const py::arg_v folder = py::arg("folder") = py::none();
    jobs::ChooseOptions choice;
    define(module,
           {"choose", "spec: str, folder: Optional[Path] = None",
            boundOptions(jobs::chooseOptions(), choice), "Row",
            R"(The smallest faithful material for a renderer, and what every candidate loses.

folder takes a page with strips of spheres, choice.json and the files of what is taken. Returns the
answer of the command; "recommended" is None where nothing is.)"},
           chosen, py::arg("spec"), folder);
    brdfs::LtcTableOptions table;
    define(module,
           {"ltc", "model: str, files: Union[Path, Sequence[Path]]",
            boundOptions(jobs::ltcOptions(), table), "Row",
            R"(Linearly transformed cosines of a model over roughness and elevation.

files: .json, or NAME.exr or NAME.dds for NAME_1 and NAME_2; one or a sequence. Returns the answer
of the command: errors of the lobes, mean and largest.)"},
           cosines, py::arg("model"), py::arg("files"));
    jobs::GaussianOptions mixture;
    define(
        module,
        {"gaussians", "spec: str, file: Path", boundOptions(jobs::gaussianOptions(), mixture),
         "Row",
         R"(Spherical or anisotropic Gaussians over wi for every outgoing direction of an isotropic
BRDF, written to a .json that open() reads. Returns the answer of the command.)"},
        mixed, py::arg("spec"), py::arg("file"));
    jobs::StressOptions stress;
    define(module,
           {"stress", "specs: Sequence[str] = (), folder: Optional[Path] = None",
            boundOptions(jobs::stressOptions(), stress), "Row",
            R"(The accuracy of each computation by degree, order and width of the lobe.

specs: lobes to project; none: Lambert, and Phong, GGX and Ward from broad to a mirror. Returns the
answer of the command; folder takes stress.json, stress.md and stress.csv.)"},
           stressed, py::arg("specs") = py::tuple(), folder);
}

}  // namespace

void bindTrades(py::module_& module) {
    bindAnswers(module);
    jobs::TradeoffOptions options;
    define(module,
           {"tradeoff", "specs: Union[Path, Sequence[Path]], folder: Optional[Path] = None",
            optionsOf(options), "Row",
            R"(Bytes, time and error of every form of BRDFs: what accuracy costs.

specs: specifications or paths, one or a sequence; folder takes pages and tables. Of what is tried,
sequences. Returns the answer of the command: of each BRDF its forms, fronts and the choice. A BRDF
of several that fails is left out, with a warning.)"},
           traded, py::arg("specs"), py::arg("folder") = py::none());
}

}  // namespace hshfit::python
