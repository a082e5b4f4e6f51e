#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/representation/split.h>
#include <hshfit/time_limit.h>
#include <hshfit/tradeoff/kept_projections.h>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace hshfit::tradeoff {

/// Makes representations of one BRDF in any form of a sweep.
class Maker {
public:
    /// `folder` is of earlier runs; all outlive this.
    Maker(const Brdf& brdf, const ProjectionOptions& projection, const ProjectionFolder& folder,
          const BrdfOpener& open)
        : brdf_(brdf), projection_(projection), folder_(folder), open_(open) {}

    /// Projects what the forms need; `done` is called after each projection.
    void prepare(const std::vector<Form>& forms, const TimeLimit& limit,
                 const std::function<void()>& done);
    static std::size_t projectionsFor(const std::vector<Form>& forms);

    /// Throws NumericError for a form that cannot be had.
    Representation make(const Form& form) const;
    double projectionSeconds(const Form& form) const { return partOf(form).kept->seconds(form); }

private:
    /// The remainder of the BRDF after one split, and its projections.
    struct Part {
        Split split;
        std::unique_ptr<KeptProjections> kept;
        std::string failure;  ///< why there is no such split
    };
    void prepareOne(const std::string& name, Part& part) const;
    const Part& partOf(const Form& form) const;

    const Brdf& brdf_;
    const ProjectionOptions& projection_;
    const ProjectionFolder& folder_;
    const BrdfOpener& open_;
    std::map<std::string, Part> parts_;
};

}  // namespace hshfit::tradeoff
