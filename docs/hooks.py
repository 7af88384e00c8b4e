# SPDX-License-Identifier: Apache-2.0
"""Add the pages of the site that lie outside `docs/`."""

from pathlib import Path

from mkdocs.structure.files import File

ROOT = Path(__file__).resolve().parents[1]
# Page of the site -> file of the repository, whose links are relative to the root.
OUTSIDE = {"changelog.md": "CHANGELOG.md", "contributing.md": "CONTRIBUTING.md"}
BIBLIOGRAPHY = "## Bibliography\n"


def on_files(files, config):
    """Add the changelog, contributing and the bibliography of the README."""
    pages = {page: ROOT / name for page, name in OUTSIDE.items()}
    for page, path in pages.items():
        files.append(File.generated(config, page, abs_src_path=str(path)))
    bibliography = (ROOT / "README.md").read_text(encoding="utf-8").partition(BIBLIOGRAPHY)[2]
    text = f"# Bibliography\n{bibliography}"
    files.append(File.generated(config, "bibliography.md", content=text))
    return files


def on_page_markdown(markdown, page, **_):
    """Make links relative to `docs/`."""
    return markdown.replace("](docs/", "](") if page.file.src_uri in OUTSIDE else markdown
