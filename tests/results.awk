# What runs of ctest say, in pairs of files: NAME.console (ctest -O) and NAME.log (its LastTest.log).
# A later run of a test replaces an earlier one.
#   awk -v want=again -f results.awk FILES    names of failed tests that may be tried again, a line each
#   awk -v want=closing -f results.awk FILES  closing lines: failed, flaky, skipped, and the sum last
# A GoogleTest program counts as the cases in it, anything else as one. LastTest.log alone does not
# tell: it calls a test passed that was skipped or never run, so what became of it is read from the console.

FNR == 1 {
  is_console = FILENAME ~ /\.console$/
  list = output = 0
  if (is_console) split("", became)
}

is_console && /^The following tests (FAILED|did not run):/ { list = 1; next }
is_console && list && match($0, /^\t *[0-9]+ - [^ ]+ \([^)]*\)/) {
  split(substr($0, RSTART, RLENGTH), part, / - | \(|\)/)
  became[part[2]] = part[3]
  next
}
is_console { if (!/^\t/) list = 0; next }

/^[0-9]+\/[0-9]+ Testing: / {
  name = $NF
  if (!(name in order)) { order[name] = ++names; name_of[names] = name }
  if (name in result && result[name] == "failed") { failed_before[name] = why[name]; }
  good = bad = left = crashed = output = 0
  reasons = broken = said = ""
  next
}
/^Output:$/ { output = 1; next }
!output { next }

/^\[  PASSED  \] [0-9]+ test/ { good = $4 }
/^\[  SKIPPED \] [0-9]+ test/ { left = $4 }
/^\[  FAILED  \] [0-9]+ test/ { bad = $4 }
/^\[  FAILED  \] .*\([0-9]+ ms\)$/ { broken = broken (broken ? ", " : "") $4 }
/: Skipped$/ { expects_reason = 1; next }
expects_reason { reason = $0; expects_reason = 0 }
/^\[  SKIPPED \] .*\([0-9]+ ms\)$/ { reasons = reasons name ", " $4 ": " reason "\n" }
/^SKIP: / { said = substr($0, 7) }
/^FAIL: / && !broken { broken = substr($0, 7) }
# What must not be taken for bad luck.
/ERROR: (Address|Leak)Sanitizer|WARNING: ThreadSanitizer|: runtime error: / { crashed = 1 }
/Segmentation fault|core dumped|terminate called|stack smashing|double free/ { crashed = 1 }
/(killed by|crashed:) signal (4|6|7|8|11)([^0-9]|$)/ { crashed = 1 }

/^<end of output>$/ {
  how = name in became ? became[name] : "Passed"
  passed_in[name] = good; skipped_in[name] = left; failed_in[name] = 0; skips[name] = reasons; crash[name] = 0
  if (how == "Passed") {
    result[name] = "passed"
    if (good + left == 0) passed_in[name] = 1
  } else if (how == "Skipped" || how == "Disabled") {
    result[name] = "skipped"
    skipped_in[name] = 1
    skips[name] = name ": " (said ? said : "says no reason") "\n"
  } else {
    result[name] = "failed"
    failed_in[name] = bad ? bad : 1
    crash[name] = crashed || (how != "Failed" && how != "Timeout")
    why[name] = broken ? broken : how == "Timeout" ? "took too long" : tolower(how)
  }
  output = 0
}

END {
  for (i = 1; i <= names; ++i) {
    name = name_of[i]
    if (want == "again") {
      if (result[name] == "failed" && !crash[name]) print name
      continue
    }
    passed += passed_in[name]; skipped += skipped_in[name]; failed += failed_in[name]
    if (result[name] == "failed") failures = failures "failed: " name " (" why[name] ")\n"
    else if (name in failed_before) flakes = flakes "flaky: " name " (" failed_before[name] ")\n"
    count = split(skips[name], line, "\n")
    for (k = 1; k < count; ++k) left_out = left_out "skipped: " line[k] "\n"
  }
  if (want == "closing")
    printf "%s%s%s%d passed, %d failed, %d skipped\n", left_out, flakes, failures, passed, failed, skipped
}
