# What every target of the project has in common. Warnings and floating-point rules are PRIVATE: a consumer never inherits them.
function(spherechain_target target standard)
  target_compile_features(${target} PUBLIC cxx_std_${standard})
  target_compile_options(${target} PRIVATE
    -Wall -Wextra -Wconversion -Wpedantic $<$<BOOL:${SPHERECHAIN_WERROR}>:-Werror>
    # One arithmetic everywhere: a fused multiply-add rounds once instead of twice, so pairs would differ between machines.
    -ffp-contract=off)
endfunction()
