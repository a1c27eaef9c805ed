"""Words from a stranger's file stay comments of the code that is exported, in every language."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest
from exported import LANGUAGES, run, validate_shader
from test_export import expected, random_rows, worst

import skyfit
from skyfit.export import FORMATS, export_fit


FIT = Path(__file__).parent / "files" / "fit_schema_2_nodes.json"
# What ends a docstring, a comment of several lines, and one of a line; what continues one.
WORDS = (
    '"""\nraise SystemExit\n"""',
    "'''\nraise SystemExit\n'''",
    "*/\n#error here\n/*",
    "/* */",
    "\n#error here\nthrow 1;",
    "\r#error here\rthrow 1;",
    "\x0c\x0b\x1c\x85\u2028\u2029throw 1;",
    "backslash \\",
    "backslash of C ??/",
    r"\N{no} \x \u \777",
    '"',
    "</script><!-- -->",
    "\x00",
)


def of_a_stranger(words):
    """A fit whose every word has these at its end."""
    fit = skyfit.load_fit(FIT)
    campaign = {"orders": words, "geometry": words, "atmosphere": {words: words}}
    atmosphere = [{"constituents": [{"density": {"type": words}, "phase": {"type": words}}]}]
    data = {"title": words, "campaign": json.dumps(campaign), "atmosphere": json.dumps(atmosphere)}
    provenance = {"data": data, "versions": {"skyfit": words}}
    notes = dataclasses.replace(fit.notes, provenance=provenance)
    return dataclasses.replace(fit, notes=notes)


@pytest.mark.parametrize("words", WORDS)
def test_a_docstring_holds_any_words_of_a_file(words, tmp_path):
    fit = of_a_stranger(words)
    code = export_fit(fit, "python")
    compile(code, "sky", "exec")
    data = random_rows(5, 50)
    got = run(code, "python", data, tmp_path)
    assert worst(got, expected(fit.sky(turbidity=np.clip(data[:, 9], 2.0, 6.0)), data)) < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("language", [one for one in LANGUAGES if one != "python"])
def test_comments_hold_any_words_of_a_file(language, tmp_path):
    fit = of_a_stranger("\n".join(WORDS))
    data = random_rows(5, 50, deepest_sun=88.0)
    want = expected(fit.sky(turbidity=np.clip(data[:, 9], 2.0, 6.0)), data)
    for words in ("\n".join(WORDS), *WORDS):
        code = export_fit(of_a_stranger(words), language)
        if words == WORDS[-1] or "\n" in words:
            assert worst(run(code, language, data, tmp_path), want.copy()) < 1e-4
        assert code.count("\n") == export_fit(of_a_stranger("plain"), language).count("\n")


@pytest.mark.slow
def test_glslang_takes_any_words_of_a_file(tmp_path):
    main = "layout(location = 0) out vec4 colour;\nvoid main() { colour = vec4(1); }"
    for words in WORDS:
        code = export_fit(of_a_stranger(words), "glsl")
        done = validate_shader(f"#version 450\n{code}\n{main}\n", tmp_path)
        assert done.returncode == 0, done.stdout


def test_words_of_a_file_are_one_printable_line_each():
    for language in FORMATS:
        code = export_fit(of_a_stranger("\n".join(WORDS)), language)
        assert code.isascii()
        assert code.replace("\n", "").isprintable()
        if language == "json":
            assert len(json.loads(code)["provenance"]) == 9
