#include <brdfs/catalog/tables.h>

#include <brdfs/analytic/abc.h>
#include <brdfs/analytic/abg.h>
#include <brdfs/analytic/ashikhmin_shirley.h>
#include <brdfs/analytic/beckmann.h>
#include <brdfs/analytic/blinn_phong.h>
#include <brdfs/analytic/charlie.h>
#include <brdfs/analytic/cook_torrance.h>
#include <brdfs/analytic/disney.h>
#include <brdfs/analytic/eon.h>
#include <brdfs/analytic/ggx.h>
#include <brdfs/analytic/gltf_pbr.h>
#include <brdfs/analytic/gtr.h>
#include <brdfs/analytic/hapke.h>
#include <brdfs/analytic/harvey_shack.h>
#include <brdfs/analytic/he.h>
#include <brdfs/analytic/lafortune.h>
#include <brdfs/analytic/lambert.h>
#include <brdfs/analytic/minnaert.h>
#include <brdfs/analytic/openpbr.h>
#include <brdfs/analytic/oren_nayar.h>
#include <brdfs/analytic/phong.h>
#include <brdfs/analytic/ross_li.h>
#include <brdfs/analytic/rough_glass.h>
#include <brdfs/analytic/rpv.h>
#include <brdfs/analytic/sg.h>
#include <brdfs/analytic/sgd.h>
#include <brdfs/analytic/ward.h>
#include <brdfs/catalog/metal_spec.h>
#include <brdfs/composed/sum.h>
#include <brdfs/measured/bsdf_xml/bsdf_xml.h>
#include <brdfs/measured/bsdf_xml/klems_writer.h>
#include <brdfs/measured/bsdf_xml/tree_writer.h>
#include <brdfs/measured/gridded/mit.h>
#include <brdfs/measured/gridded/slice.h>
#include <brdfs/measured/gridded/slice_writer.h>
#include <brdfs/measured/gridded/utia.h>
#include <brdfs/measured/material_library.h>
#include <brdfs/measured/merl.h>
#include <brdfs/measured/merl_writer.h>
#include <brdfs/measured/pbsdf.h>
#include <brdfs/measured/rgl.h>
#include <brdfs/measured/rgl_writer.h>
#include <brdfs/measured/scattered/alta.h>
#include <brdfs/measured/scattered/alta_writer.h>
#include <brdfs/measured/scattered/astm.h>
#include <brdfs/measured/scattered/bird.h>
#include <brdfs/measured/scattered/cornell.h>
#include <brdfs/measured/scattered/csv.h>
#include <brdfs/measured/scattered/fred.h>
#include <brdfs/measured/scattered/nist.h>
#include <brdfs/measured/scattered/pab_opto.h>
#include <brdfs/measured/scattered/scatmech.h>
#include <brdfs/measured/scattered/scattered.h>
#include <brdfs/measured/scattered/speos.h>
#include <brdfs/measured/scattered/xompt.h>
#include <brdfs/measured/scattered/xompt_writer.h>
#include <brdfs/measured/scattered/zemax.h>
#include <brdfs/measured/scattered/zemax_writer.h>
#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>

namespace hshfit::brdfs {

std::span<const Model> models() {
    // One line a row.
    // clang-format off
    static const std::vector<Model> table{
        lambertModel(),
        orenNayarModel(),
        eonModel(),
        openpbrDiffuseModel(),
        minnaertModel(),
        phongModel(),
        blinnPhongModel(),
        lafortuneModel(),
        wardModel(),
        ashikhminShirleyModel(),
        cookTorranceModel(),
        heModel(),
        abcModel(),
        sgdModel(),
        beckmannModel(),
        ggxModel(),
        gtrModel(),
        disneyModel(),
        gltfPbrModel(),
        openpbrModel(),
        charlieModel(),
        sgModel(),
        abgModel(),
        harveyShackModel(),
        rossLiModel(),
        rpvModel(),
        hapkeModel(),
        lambertTransmissionModel(),
        roughGlassModel(),
    };
    // clang-format on
    return table;
}

std::span<const Format> formats() {
    static const std::vector<Format> table{
        merlFormat(),  materialLibraryFormat(), pbsdfFormat(),
        rglFormat(),   bsdfXmlFormat(),         altaFormat(),
        astmFormat(),  zemaxFormat(),           fredFormat(),
        speosFormat(), cornellFormat(),         xomptFormat(),
        birdFormat(),  pabOptoFormat(),         csvFormat(),
        nistFormat(),  scatmechFormat(),        mitFormat(),
        utiaFormat(),  slicesFormat(),          merlSliceFormat()};
    return table;
}

std::span<const Writer> writers() {
    static const std::vector<Writer> table{merlWriter(),   rglWriter(),       altaWriter(),
                                           slicesWriter(), bsdfKlemsWriter(), bsdfTreeWriter(),
                                           zemaxWriter(),  xomptWriter()};
    return table;
}

const Model* findModel(std::string_view name) {
    const auto found = std::ranges::find(models(), name, &Model::name);
    return found == models().end() ? nullptr : &*found;
}

void refuseModel(std::string_view name) {
    std::vector<std::string_view> known;
    for (const Model& row : models()) known.push_back(row.name);
    throw UsageError(fmt::format("unknown model '{}'{}; known: {}", name, suggestion(name, known),
                                 joined(known)));
}

std::unique_ptr<Brdf> openModel(std::string_view spec) {
    const std::size_t colon = spec.find(':');
    const Model* model = findModel(spec.substr(0, colon));
    if (!model) refuseModel(spec.substr(0, colon));
    const std::string_view values =
        colon == std::string_view::npos ? std::string_view() : spec.substr(colon + 1);
    if (namesMetal(values)) return openMetal(spec);
    return model->make(parseParameters(model->name, model->parameters, values));
}

std::unique_ptr<Brdf> openModels(std::string_view spec) {
    const auto terms = splitSum(spec, [](std::string_view) { return false; });
    if (terms.size() == 1 && terms.front().weight == 1) return openModel(terms.front().spec);
    std::vector<Sum::Term> opened;
    for (const WeightedSpec& term : terms) opened.push_back({term.weight, openModel(term.spec)});
    return std::make_unique<Sum>(std::move(opened));
}

}  // namespace hshfit::brdfs
