#!/bin/sh
# Unpacks Debian's qemu-system-arm, with all that it needs and that is not installed, into the folder $1 of this project.
# Installs nothing: for systems where installing it would cost the user another package (a newer qemu-utils, say).
set -eu
folder=$1
trap 'rm -rf "$folder.new"' EXIT
rm -rf "$folder.new"
mkdir -p "$folder.new"
cd "$folder.new"

# Each line: 'address' name_version_architecture.deb size checksum
apt-get install --yes --quiet --no-install-recommends --print-uris qemu-system-arm > packages
names=$(sed -n "s/^'[^']*' \([^_ ]*\)_.*/\1/p" packages)
# shellcheck disable=SC2086 # a list of words
apt-get download --quiet -o Acquire::http::Timeout=30 -o Acquire::Retries=1 $names
for package in *.deb; do
    dpkg-deb --extract "$package" .
done
rm -- packages *.deb

# QEMU finds its data beside itself, but not its libraries.
cat > qemu-system-arm <<'END'
#!/bin/sh
here=$(dirname "$(readlink -f "$0")")
for folder in "$here"/usr/lib/*-linux-gnu* "$here"/lib/*-linux-gnu*; do
    LD_LIBRARY_PATH=$folder${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
done
export LD_LIBRARY_PATH
exec "$here/usr/bin/qemu-system-arm" "$@"
END
chmod 755 qemu-system-arm
./qemu-system-arm --version

rm -rf "$folder"
mv "$folder.new" "$folder"
