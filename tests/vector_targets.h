#pragma once

#include <hshfit/vector_targets.h>

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cstdint>
#include <functional>

namespace hshfit::test {

/// `check` with each instruction set that the machine has, one after the other.
inline void forEveryTarget(const std::function<void()>& check) {
    const auto use = [](std::int64_t targets) {
        hwy::SetSupportedTargetsForTest(targets);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    };
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        SCOPED_TRACE(hwy::TargetName(target));
        use(target);
        check();
    }
    use(0);
}

}  // namespace hshfit::test
