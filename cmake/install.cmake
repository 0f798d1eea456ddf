# Filled by the packaging: installed headers, perpConfig, pkg-config.
