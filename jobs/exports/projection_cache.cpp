#include "projection_cache.h"

#include <jobs/source/content_key.h>

#include <string>

namespace hshfit::jobs {

void useCache(tradeoff::ProjectionFolder& folder, const Listener& listener,
              const std::filesystem::path& beside) {
    if (!folder.isUsed()) return;
    folder.make();
    folder.contentOf = [beside](const Brdf& brdf, const std::string& specification) {
        return filesKey(specification, beside) + valuesKey(brdf);
    };
    folder.tell = [listener](const std::string& remark) { listener.say(remark); };
}

}  // namespace hshfit::jobs
