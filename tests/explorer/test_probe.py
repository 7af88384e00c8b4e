# SPDX-License-Identifier: Apache-2.0
"""The probe's values, and the texts that readers copy."""

import re
import subprocess
import sys

import numpy as np

import mxeon
from mxeon.models import eon_brdf
from tests.explorer.browser import show, until

# Roundings of float32 in a shader's value, of which it makes fewer than 64.
SHADER = 64 * 2**-24


# The texts of the table's rows, once the values of both shaders are read back.
READ = """(() => {
    const rows = [...document.querySelectorAll('.values tbody tr')].map(
        row => [...row.querySelectorAll('td')].map(cell => cell.innerText));
    const texts = rows.flat().join();
    return texts.includes('float32') && !texts.includes('measuring') && rows;
})()"""


def numbers(text):
    return [float(word) for word in re.findall(r"[+-]?\d+\.\d+", text.replace("−", "-"))]


def values_read(page):
    return until(page, READ)


def test_the_probe_shows_the_value_of_the_shader_and_the_reference(page):
    rows = values_read(page)
    wo, wi = np.reshape(numbers(page.locator(".directions").inner_text()), (2, 3))
    value, reference = (numbers(rows[row][0]) for row in (0, 1))
    wo, wi = wo / np.linalg.norm(wo), wi / np.linalg.norm(wi)
    expected = np.pi * eon_brdf(wo, wi, [0.8, 0.4, 0.1], 1.0) * wi[2]
    assert np.allclose(reference, expected, atol=1e-3)  # directions are shown with four digits
    assert np.allclose(value, reference, atol=SHADER)
    assert "rounding" in rows[2][0]


def copied(page, side, what):
    page.get_by_role("button", name=f"Copy {side} as {what}").click()
    until(page, f"document.querySelector('.copies .said').textContent === '{side}, {what} copied.'")
    return page.evaluate("navigator.clipboard.readText()")


def test_the_python_line_runs_and_gives_the_value(page):
    rows = values_read(page)
    for column, side in enumerate("AB"):
        line = copied(page, side, "Python")
        command = [sys.executable, "-c", line]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        found = [float(word) for word in done.stdout.split()]
        assert np.allclose(found, numbers(rows[0][column]), atol=SHADER)


CHANGED = """async () => {
    mxeon.show({...mxeon.state(), roughness: 0.3});
    await null;  // the page is drawn anew by then
    return [...document.querySelectorAll('.values tbody tr:first-child td')].map(e => e.innerText);
}"""


def test_a_value_of_another_view_is_never_shown(page):
    values_read(page)
    assert page.evaluate(CHANGED) == ["measuring…", "measuring…"]


def test_the_copied_document_is_the_material_in_sight(page):
    show(page, roughness=0.25, color=[0.5, 0.25, 0.125])
    page.locator(".side.left").get_by_label("energy_compensation").uncheck()
    text = copied(page, "A", "MaterialX")
    values = {port.name: port.value for port in mxeon.generate(text, "essl")[0].inputs}
    assert values["lobe_color"] == (0.5, 0.25, 0.125) and values["lobe_roughness"] == 0.25
    assert values["lobe_energy_compensation"] is False


def test_the_link_is_the_address_of_the_view(page):
    show(page, exposure=2)
    until(page, "location.hash.includes('exposure=2')")
    page.get_by_role("button", name="Copy a link").click()
    until(page, "document.querySelector('header .said').textContent === 'Copied'")
    assert page.evaluate("navigator.clipboard.readText()").endswith("#exposure=2")
