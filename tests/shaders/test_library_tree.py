# SPDX-License-Identifier: Apache-2.0
"""Complete and partial copies of MaterialX's libraries can replace the installed libraries."""

import json
import shutil

import MaterialX as mx
import pytest

import mxeon
from mxeon.cli import main
from mxeon.shaders.library_export import export_library
from mxeon.shaders.library_tree import OVERLAY, PART, tree
from tests.support.command import PLASTER, run
from tests.support.plans import keep
from tests.support.sharing import DRAWN
from tests.support.wheels import wheel
from tests.support.wrong_libraries import GLSL, STOCK, copy_of_stock, replace_text

SHEEN, LIB = f"{GLSL}/mx_sheen_bsdf.glsl", f"{GLSL}/lib/mx_microfacet_sheen.glsl"
BURLEY = [f"{GLSL}/mx_burley_diffuse_bsdf.glsl", f"{GLSL}/lib/mx_microfacet_diffuse.glsl"]
PARTS = {"pbrlib": ["pbrlib"], "a node and its lib": BURLEY, "a file of lib": BURLEY[1:]}


@pytest.fixture(autouse=True)
def few_programs(monkeypatch):
    """Omit the checks that compile additional programs."""
    keep(monkeypatch, lambda task: task.check not in (*DRAWN, "states"))


def findings(libraries, nodes, hosts=("gl",)):
    """Verdict, error, diagnosis and pages of each check, for each library."""
    run = mxeon.check(None, hosts, libraries, nodes=nodes)
    found = {library: {} for library in libraries}
    for each in run.results:
        key = each.host, each.check, each.subject
        if each.check != "release":  # only libraries in folders are compared with the release
            found[each.library][key] = each.verdict, each.error, each.diagnosis, each.pages
    return found.values()


def test_an_unchanged_copy_of_materialx_has_the_verdicts_of_stock(gl, tmp_path):
    nodes = ("translucent_bsdf", "surface", "measured_edf", "glossiness_anisotropy")
    stock, whole = findings(["stock", str(copy_of_stock(tmp_path / "whole"))], nodes)
    assert len(stock) > 8 and whole == stock


@pytest.mark.parametrize("name", PARTS)
def test_a_part_is_completed_by_the_installed_libraries(gl, tmp_path, name):
    copy = copy_of_stock(tmp_path, *PARTS[name])
    stock, part = findings(["stock", str(copy)], ["burley_diffuse_bsdf"])
    assert part == stock
    files = tree(str(copy))
    assert files.kind == PART and len(files.own) + len(files.package) == len(tree(str(STOCK)).own)


@pytest.mark.parametrize("part, name", [("", "eonlib"), ("documents/diffuse", "diffuse")])
def test_an_export_of_eonlib_has_its_verdicts(gl, tmp_path, part, name):
    copy = export_library(tmp_path / "export") / part
    eonlib, export = findings([name, str(copy)], ["surface", "measured_edf", "eon_diffuse_bsdf"])
    assert eonlib and export == eonlib
    assert tree(str(copy)).kind == OVERLAY


# Faults in a copy: the file, the original code, its replacement, the node, the check that is
# reported first, and words of the message.
FAULTS = {
    "a file of lib": (LIB, "D = mx_", "D = 3.0 * mx_", "sheen_bsdf", "value", "3 times the right"),
    "an implementation": (
        f"{GLSL}/pbrlib_genglsl_impl.mtlx",
        'file="mx_layer_bsdf.glsl" function="mx_layer_bsdf"',
        'file="mx_add_bsdf.glsl" function="mx_add_bsdf"',
        *("layer", "combination", "a base that receives all light"),
    ),
}


@pytest.mark.parametrize(
    "name, parts", [("a file of lib", ["pbrlib"]), *((each, []) for each in FAULTS)]
)
def test_a_fault_in_a_copy_is_found_and_told_first(gl, tmp_path, capsys, monkeypatch, name, parts):
    file, old, new, node, key, words = FAULTS[name]
    keep(monkeypatch, lambda task: task.subject in (node, f"{node}, mode conty_kulla"))
    copy = copy_of_stock(tmp_path / "copy", *parts)
    replace_text(copy, old, new, file)
    assert main(["check", "--library", str(copy), "--node", node, "--workers", "0"]) == 1
    verdict, origin, unjudged, *rows = capsys.readouterr().out.splitlines()
    first = rows[0] if unjudged.startswith("not judged here: ") else unjudged
    own = len(tree(str(copy)).own)
    rest = len(tree(str(STOCK)).own) - own or "none"
    assert f" MaterialX {mx.getVersionString()}. Finished in " in verdict
    assert origin.startswith(f"library {copy}: {own} files from the folder, {rest} from MaterialX ")
    assert first.startswith(f"failed: gl with {copy}: {node}") and f"({key}" in first
    assert words in first


def test_a_run_lists_the_files_of_folder_and_package_and_the_lobes_without_a_model(
    gl, tmp_path, capsys
):
    copy, report = copy_of_stock(tmp_path / "copy", SHEEN, LIB), tmp_path / "report"
    lobe = '<nodedef name="ND_own" node="own_bsdf"><output name="out" type="BSDF" /></nodedef>'
    (copy / "own.mtlx").write_text(f'<materialx version="1.39">{lobe}</materialx>')
    options = ["--library", str(copy), "--node", "glossiness_anisotropy", "--workers", "0"]
    assert main(["check", *options, "--json", "--report", str(report)]) == 0
    [(folder, files)] = json.loads(capsys.readouterr().out)["libraries"].items()
    own = [SHEEN, LIB, "own.mtlx"]
    assert folder == str(copy) and sorted(files["folder"]) == sorted(own)
    assert {*files["folder"], *files["MaterialX"]} == {*tree(str(STOCK)).own, "own.mtlx"}
    line = f"<p>library {copy}: 3 files from the folder, {len(files['MaterialX'])} from MaterialX "
    page = (report / "report.html").read_text()
    assert line in page and f"own_bsdf ({copy} adds this node, which has no model)" in page
    assert main(["check", *options, "--full"]) == 0
    rows = {*capsys.readouterr().out.splitlines()}
    assert {f"library {copy}: {where}: {each}" for where in files for each in files[where]} <= rows


def elsewhere(folder):
    copy_of_stock(folder, SHEEN)
    (folder / GLSL).rename(folder / "gl")
    return f"gl/mx_sheen_bsdf.glsl must lie at {SHEEN} to replace MaterialX's file of that name"


def package(folder):
    copy_of_stock(folder / "libraries")
    return f"must be the folder with targets, stdlib, pbrlib; pass {folder}/libraries"


def other_generator(folder):
    math = "stdlib/genglsl/lib/mx_math.glsl"
    replace_text(copy_of_stock(folder), "mx_matrix_mul(", "own_mul(", math)
    return "has no mx_matrix_mul, which glsl calls: pass the right MaterialX build with --materialx"


def unknown_token(folder):
    source = "pbrlib/genglsl/lib/mx_closure_type.glsl"
    replace_text(copy_of_stock(folder), "$closureDataConstructor", "$newToken /* $a */", source)
    return "glsl does not replace its $newToken: pass the right MaterialX build with --materialx"


def holding(*names):
    def make(folder):
        for name in names:
            (folder / name).write_text("")
        return "it has no such file" if names else "it is empty"

    return make


@pytest.mark.parametrize(
    "make",
    [elsewhere, package, other_generator, unknown_token, holding(), holding("own.glsl", "a.txt")],
)
def test_what_cannot_be_combined_is_refused_in_one_sentence(tmp_path, capsys, make):
    words = make(tmp_path)
    arguments = ["--library", str(tmp_path), "--node", "sheen_bsdf", "--workers", "0"]
    assert main(["check", *arguments]) == 2
    out, error = capsys.readouterr()
    assert out == "" and error.count("\n") == 1
    assert error.startswith(f"mxeon: library {tmp_path}: ") and words in error


def test_a_token_in_a_source_that_is_loaded_first_did_not_run(tmp_path, capsys):
    library = export_library(tmp_path / "mine")
    source = library / "genglsl" / "lib" / "eon.glsl"
    source.write_text(f"float own() {{ return $own; }}\n{source.read_text()}")
    target = ["--target", "glsl", "--outputPath", str(tmp_path), "--workers", "0"]
    assert main(["generate", PLASTER, "--library", str(library), *target]) == 3
    assert "does not replace $own in the library's sources" in capsys.readouterr().err


@pytest.mark.parametrize("workers", "01")
def test_materialx_takes_a_build_in_every_process(gl, tmp_path, workers):
    build = wheel("1.39.4")
    copy = shutil.copytree(build / "MaterialX" / "libraries", tmp_path / "libraries")
    options = ["--materialx", build, "--node", "translucent_bsdf", "--workers", workers]
    done = [run("check", "--library", each, *options) for each in ("stock", copy)]
    assert max(each.returncode for each in done) < 2, done[0].stderr + done[1].stderr
    stock, whole = (each.stdout for each in done)
    assert f"MaterialX 1.39.4, from {build}." in stock.splitlines()[0]
    first, second = whole.splitlines()[:2]
    verdict = stock.splitlines()[0].replace("stock", str(copy)).partition(" Finished in ")[0]
    failed, _, total, rest = verdict.split(" ", 3)
    # Definitions and graphs of a folder are compared with the release, which is one more check.
    assert first.startswith(f"{failed} of {int(total) + 1} {rest} Finished in ")
    assert second.endswith("from the folder, none from MaterialX 1.39.4")
