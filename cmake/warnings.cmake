# Compiler flags that every target of ours takes, by linking nephele_flags.
add_library(nephele_flags INTERFACE)
target_compile_options(nephele_flags INTERFACE
  -Wall -Wextra -Wshadow -Wpointer-arith -Wundef -Wvla
  $<$<COMPILE_LANGUAGE:C>:-Wstrict-prototypes -Wmissing-prototypes>
  # The same bytes from every compiler and processor: a product and a sum stay two roundings.
  -ffp-contract=off
  # Neither changes a value; both let square roots and loops be vectorised.
  -fno-math-errno -fno-trapping-math
  # gcc 12 forgets the rounding in (double)(float)x where it packs two such statements into one vector.
  $<$<C_COMPILER_ID:GNU>:-fno-tree-slp-vectorize>)
# A loop that clang does not vectorise (under the sanitizers, for instance) is slower, not wrong.
target_compile_options(nephele_flags INTERFACE $<$<C_COMPILER_ID:Clang>:-Wno-pass-failed>)
target_compile_definitions(nephele_flags INTERFACE _XOPEN_SOURCE=700)
if(NEPHELE_WERROR)
  target_compile_options(nephele_flags INTERFACE -Werror)
endif()
if(NEPHELE_SANITIZE)
  target_compile_options(nephele_flags INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(nephele_flags INTERFACE -fsanitize=address,undefined)
endif()
if(NEPHELE_THREAD_SANITIZE)
  target_compile_options(nephele_flags INTERFACE -fsanitize=thread -fno-omit-frame-pointer)
  target_link_options(nephele_flags INTERFACE -fsanitize=thread)
endif()
if(NEPHELE_COVERAGE)
  # Atomic: rows are counted by several threads. No inlining, so that a line is counted where it stands.
  target_compile_definitions(nephele_flags INTERFACE NEPHELE_COVERAGE)
  target_compile_options(nephele_flags INTERFACE --coverage -fprofile-update=atomic -fno-inline)
  target_link_options(nephele_flags INTERFACE --coverage)
endif()
