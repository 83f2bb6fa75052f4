"""The documentation site: pages that are made from sources and from runs."""
