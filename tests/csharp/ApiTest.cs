// SPDX-License-Identifier: MIT
// ApiTest.exe ASSET.sphc PALETTES: what the classes promise. Prints what fails.
using System;
using System.IO;
using System.Linq;
using System.Threading;
using Spherechain;

public static class ApiTest
{
    const MatrixLayout kColumns = MatrixLayout.Columns4x4;
    static float[] deepest;
    static int checks, failures;

    static void Check(bool holds, string what)
    {
        ++checks;
        if (holds) return;
        Interlocked.Increment(ref failures);
        Console.WriteLine("FAILED: " + what);
    }

    static void Refused(string what, Code code, string field, string text, Action action)
    {
        try
        {
            action();
            Check(false, what + " is refused");
        }
        catch (SpherechainException error)
        {
            Check(error.Code == code && error.FieldName == field && error.Message.Contains(text),
                  string.Format("{0}: {1}, {2}, \"{3}\"", what, error.Code, error.FieldName, error.Message));
        }
    }

    // The palette of the frame in which most parts meet.
    static float[] Deepest(byte[] file, Palettes model)
    {
        using (Character character = new Character(file, model.Joints))
        {
            return model.Frames.Where((p, i) => i % 6 == 0).OrderByDescending(palette => character.FindPenetrations(palette, kColumns)).First();
        }
    }

    static void AssetIsRead(byte[] file)
    {
        using (Asset asset = new Asset(file))
        {
            Check(asset.SphereCount > 50 && asset.BoneCount > 10 && asset.PartCount > 10 && asset.TriangleCount > 1000, "counts");
            Check(asset.PartNames.Contains("left hand") && asset.PartNames.Contains("head"), "names of parts");
            int hand = Array.IndexOf(asset.PartNames, "left hand");
            Check(asset.PartSide(hand) == Side.Left && asset.PartBone(hand) >= 0, "the left hand");
            Check(asset.PartNames[asset.PartParent(hand)] == "left forearm", "the hand hangs on the forearm");
            Check(asset.RestSphere(3).Radius > 0 && asset.RestSphere(3).Region < 100, "a sphere at rest");
            Check(asset.Writer.StartsWith("spherechain ") && asset.SourceSha256.Length == 64 && asset.Settings.StartsWith("{"), "texts");
            Check(asset.Height > 0 && asset.MetresPerUnit > 0 && Math.Abs(asset.Up.Y) > 0.9f, "axes");
            float[] bind = new float[12];
            asset.InverseBind(asset.PartBone(hand), bind);
            Check(bind.Any(x => x != 0), "an inverse bind matrix");
            Refused("part -1", Code.BadValue, "index", "-1 is none of", () => asset.PartBone(-1));
            Refused("a short matrix", Code.TooSmall, "output", "12 floats", () => asset.InverseBind(0, bind, 1));
        }
        Asset closed = new Asset(file);
        closed.Dispose();
        closed.Dispose();
        Refused("a disposed asset", Code.NotOpen, "asset", "disposed", () => closed.PartSide(0));
        Refused("no file", Code.Null, "data", "null", () => new Asset((byte[])null));
        Refused("garbage", Code.NotAnAsset, "data", "", () => new Asset(new byte[200]));
        Refused("an empty file", Code.NotAnAsset, "data", "", () => new Asset(new byte[0]));
        Refused("half a file", Code.Corrupt, "data", "", () => new Asset(file.Take(file.Length / 2).ToArray()));
    }

    static void CharacterRefuses(byte[] file, Palettes model)
    {
        string[] others = model.Joints.ToArray();
        int moved = Array.IndexOf(others, "left_elbow");
        others[moved] = "left_elbow_2";
        Refused("another name", Code.NoSuchBone, "joints", "left_elbow", () => new Character(file, others, model.InverseBinds, kColumns));
        float[] binds = model.InverseBinds.ToArray();
        binds[16 * moved + 12] += 100;
        Refused("another rest pose", Code.OtherBind, "joints", "left_elbow", () => new Character(file, model.Joints, binds, kColumns));
        Refused("few matrices", Code.TooSmall, "joints", "fewer", () => new Character(file, model.Joints, new float[16], kColumns));
        Refused("no layout", Code.BadValue, "pose.bone_layout", "MatrixLayout", () => new Character(file, model.Joints, binds));
        Refused("garbage", Code.NotAnAsset, "data", "", () => new Character(new byte[64]));

        Character character = new Character(file, model.Joints, model.InverseBinds, kColumns);
        character.CheckRest(model.Rest, kColumns);
        Refused("a pose as rest", Code.OtherBind, "pose.bones", "", () => character.CheckRest(deepest, kColumns));
        Refused("no palette", Code.Null, "pose.bones", "null", () => character.FindPenetrations(null, kColumns));
        Refused("a short palette", Code.TooSmall, "pose.bone_count", "small", () => character.FindContacts(new float[32], kColumns));
        Refused("no layout", Code.BadValue, "pose.bone_layout", "", () => character.FindContacts(model.Rest, MatrixLayout.LayoutUnset));
        character.FindContacts(deepest, kColumns);
        Check(character.ContactCount > 0 && character.Contacts[0].TrianglePairs > 0, "contacts after refusals");
        character.Dispose();
        character.Dispose();
        Refused("a disposed character", Code.NotOpen, "asset", "disposed", () => character.FindContacts(model.Rest, kColumns));
        Refused("its asset", Code.NotOpen, "asset", "disposed", () => character.Asset.PartSide(0));
    }

    // By rows, and in the asset's own order: the same answers.
    static void LayoutsAgree(byte[] file, Palettes model)
    {
        float[] palette = deepest;
        using (Character character = new Character(file, model.Joints))
        {
            float[] rows = new float[palette.Length / 16 * 12];
            for (int i = 0; i < rows.Length; ++i) rows[i] = palette[i / 12 * 16 + i % 4 * 4 + i % 12 / 4];
            int count = character.FindPenetrations(palette, kColumns);
            Penetration[] expected = character.Penetrations.Take(count).ToArray();
            Check(count > 0 && character.FindPenetrations(rows, MatrixLayout.Rows3x4) == count, "rows count");
            Check(expected.SequenceEqual(character.Penetrations.Take(count)), "rows: the same bits");

            string[] names = character.Asset.BoneNames;
            using (Body body = new Body(character.Asset))
            using (Body bound = new Body(character.Asset, model.Joints, model.InverseBinds, kColumns))
            {
                float[] ordered = new float[12 * names.Length];
                for (int b = 0; b < names.Length; ++b)
                {
                    int joint = Array.IndexOf(model.Joints, names[b]);
                    for (int k = 0; k < 12; ++k) ordered[12 * b + k] = joint < 0 ? (k % 5 == 0 ? 1 : 0) : rows[12 * joint + k];
                }
                body.SetPalette(ordered, MatrixLayout.Rows3x4);
                bound.SetPalette(palette, kColumns);
                Check(body.Detect() == bound.Detect() && body.Spheres.SequenceEqual(bound.Spheres), "the asset's order");
                Refused("few bones", Code.TooSmall, "pose.bone_count", "fewer", () => body.SetPalette(new float[12], MatrixLayout.Rows3x4));
                Refused("no pose", Code.Null, "pose.bones", "SetPalette", () => body.Refit());
            }
        }
    }

    static void BodyAgrees(byte[] file, Palettes model)
    {
        int pairs = 0;
        using (Asset asset = new Asset(file))
        using (Character character = new Character(file, model.Joints))
        using (Body body = new Body(asset, model.Joints, model.InverseBinds, kColumns))
        {
            foreach (float[] palette in model.Frames.Where((p, i) => i % 6 == 0))
            {
                character.FindContacts(palette, kColumns);
                body.SetPalette(palette, kColumns);
                pairs += body.Detect();
                body.FindContacts(Scope.Apart);
                Check(character.Contacts.Take(character.ContactCount).SequenceEqual(body.Contacts.Take(body.ContactCount)), "contacts");
                character.FindPenetrations(palette, kColumns);
                body.MeasurePenetrations(true);
                Check(character.Penetrations.Take(character.PenetrationCount).SequenceEqual(
                          body.Penetrations.Take(body.PenetrationCount)), "penetrations");
                for (int i = 1; i < body.PairCount; ++i) Check(body.Pairs[i - 1].A <= body.Pairs[i].A, "pairs are sorted");
            }
            // In full, some frame has a volume that is known, and a line that is partly hidden.
            bool hasVolume = false, isHidden = false;
            for (int frame = 0; frame < model.Frames.Length; frame += 30)
            {
                body.SetPalette(model.Frames[frame], kColumns);
                body.FindContacts(Scope.All);
                body.MeasurePenetrations(false);
                hasVolume |= body.Penetrations.Take(body.PenetrationCount).Any(p => p.Measures.Volume > 0);
                isHidden |= body.Penetrations.Take(body.PenetrationCount).Any(p => p.Measures.Visible < 1);
            }
            Check(hasVolume && isHidden, "volumes and visibility");
            // The ground at the height of the knees.
            Vec3 up = asset.Up;
            int below = body.FindFloor(up, asset.Origin.Y + 0.25f * asset.Height);
            Check(below > 0 && below < asset.PartCount && body.Penetrations[0].Other == Native.Floor, "the ground: " + below);
            Check(body.Penetrations.Take(below).Any(p => asset.PartNames[p.Part].Contains("foot")), "feet are below");
            Refused("no way up", Code.BadValue, "floor", "", () => body.FindFloor(new Vec3(), 0));
        }
        Check(pairs > 20, "pairs of spheres");
    }

    static void TwoBodiesMeet(byte[] file, Palettes model)
    {
        using (Asset asset = new Asset(file))
        using (Body a = new Body(asset, model.Joints))
        using (Body b = new Body(asset, model.Joints))
        using (BodyPair pair = new BodyPair(a, b))
        using (BodyPair back = new BodyPair(b, a))
        {
            Refused("no pose", Code.Null, "pose.bones", "SetPalette", () => pair.FindContacts());
            JointTransform place = new JointTransform { Rotation3 = 1 };
            place.Scale.X = place.Scale.Y = place.Scale.Z = 1;
            foreach (float distance in new[] { 0.1f, 10 })
            {
                a.SetPalette(deepest, kColumns);
                b.SetPalette(deepest, kColumns);
                place.Translation.X = distance * asset.Height;
                b.Place(place);
                int count = pair.FindContacts();
                Check(count > 0 == distance < 1, "contacts at " + distance);
                Check(back.FindContacts() == count && back.TriangleCount == pair.TriangleCount, "contacts the other way round");
                Check(pair.MeasurePenetrations(true) == count, "measures at " + distance);
                for (int i = 0; i < pair.PenetrationCount; ++i) Check(pair.Penetrations[i].Measures.Depth > 0, "a depth");
            }
            a.SetPalette(deepest, kColumns);
            b.SetPalette(deepest, kColumns);
            place.Translation.X = 0.1f * asset.Height;
            b.Place(place);
            for (int part = 0; part < asset.PartCount; ++part) a.IgnorePart(part, true);
            Check(pair.FindContacts() == 0, "ignored parts meet nothing");
            Refused("a body with itself", Code.BadValue, "bodies", "another", () => new BodyPair(a, a));
            Refused("no part", Code.BadValue, "index", "no part", () => a.IgnorePart(asset.PartCount, true));
            place.Rotation3 = 0;
            Refused("no rotation", Code.BadValue, "transform", "", () => b.Place(place));
        }
    }

    static void FramesAllocateNothing(byte[] file, Palettes model)
    {
        using (Asset asset = new Asset(file))
        using (Character character = new Character(file, model.Joints))
        using (Body body = new Body(asset, model.Joints))
        using (Body other = new Body(asset, model.Joints))
        using (BodyPair pair = new BodyPair(body, other))
        {
            JointTransform beside = new JointTransform { Rotation3 = 1 };
            beside.Scale.X = beside.Scale.Y = beside.Scale.Z = 1;
            beside.Translation.X = 0.3f * asset.Height;
            long before = 0;
            for (int round = 0; round < 2; ++round)  // the first makes lists as large as they get, and compiles
            {
                before = GC.GetAllocatedBytesForCurrentThread();
                for (int frame = 0; frame < model.Frames.Length; frame += 18)
                {
                    character.FindPenetrations(model.Frames[frame], kColumns);
                    character.FindContacts(model.Frames[frame], kColumns);
                    body.SetPalette(model.Frames[frame], kColumns);
                    body.Detect();
                    body.FindContacts(Scope.Apart);
                    body.MeasurePenetrations(true);
                    other.SetPalette(model.Frames[0], kColumns);
                    other.Place(beside);
                    pair.FindContacts();
                }
            }
            long allocated = GC.GetAllocatedBytesForCurrentThread() - before;
            Check(allocated == 0, allocated + " bytes are allocated in frames");
            byte[] proof = new byte[100000];
            Check(GC.GetAllocatedBytesForCurrentThread() - before >= proof.Length, "what is allocated is counted");
        }
    }

    static void ThreadsShareAnAsset(byte[] file, Palettes model)
    {
        using (Asset asset = new Asset(file))
        {
            int[][] counts = new int[2][];
            Thread[] threads = new Thread[2];
            for (int t = 0; t < threads.Length; ++t)
            {
                int own = t;
                threads[t] = new Thread(() =>
                {
                    using (Body body = new Body(asset, model.Joints))
                    {
                        counts[own] = model.Frames.Skip(60).Take(20).Select(palette =>
                        {
                            body.SetPalette(palette, kColumns);
                            body.FindContacts(Scope.Apart);
                            return body.Detect() + 1000 * body.ContactCount + 10000 * body.TriangleCount;
                        }).ToArray();
                    }
                });
                threads[t].Start();
            }
            foreach (Thread thread in threads) thread.Join();
            Check(counts[0].SequenceEqual(counts[1]) && counts[0].Sum() > 0, "two threads find the same");
        }
    }

    // One character on two threads: each call either does its work or is refused, and both are seen.
    static void ACharacterIsOneThreads(byte[] file, Palettes model)
    {
        using (Character character = new Character(file, model.Joints))
        {
            int refused = 0, done = 0;
            DateTime end = DateTime.UtcNow.AddSeconds(2);
            ThreadStart work = () =>
            {
                while (Volatile.Read(ref refused) == 0 && DateTime.UtcNow < end)
                {
                    try
                    {
                        character.FindContacts(deepest, kColumns);
                        Interlocked.Increment(ref done);
                    }
                    catch (SpherechainException error)
                    {
                        Check(error.Code == Code.Aliased && error.Message.Contains("one a thread"), error.Message);
                        Interlocked.Increment(ref refused);
                    }
                }
            };
            Thread other = new Thread(work);
            other.Start();
            work();
            other.Join();
            Check(refused > 0 && done > 0, "refused " + refused + ", done " + done);
        }
    }

    // Dropped without Dispose(): the collector frees them, and not before.
    static void DroppedObjectsAreFreed(byte[] file, Palettes model)
    {
        for (int i = 0; i < 10; ++i)
        {
            Asset asset = new Character(file, model.Joints).Asset;  // the asset keeps its character
            GC.Collect();
            GC.WaitForPendingFinalizers();
            Check(asset.PartSide(0) <= Side.Right && asset.RestSphere(0).Radius > 0, "an asset outlives its character's name");
        }
    }

    static void MirrorsAreTheirOwnInverse()
    {
        float[] m = Enumerable.Range(1, 16).Select(x => (float)x).ToArray();
        float[] twice = m.ToArray();
        Mirror.ToSource(twice, 0, Axis.X, 0.5f);
        // Rows of X turned, but where row and column are; the translation twice as long.
        Check(twice.SequenceEqual(new float[] { 1, -2, -3, 4, -5, 6, 7, 8, -9, 10, 11, 12, -26, 28, 30, 16 }), "X: " + string.Join(" ", twice));
        Mirror.ToSource(twice, 0, Axis.X, 2);
        Check(twice.SequenceEqual(m), "and back");
        Mirror.ToSource(twice, 0, Axis.None);
        Check(twice.SequenceEqual(m), "none");
        Vec3 p = Mirror.PointToEngine(new Vec3 { X = 1, Y = 2, Z = 3 }, Axis.Z, 2);
        Check(p.X == 2 && p.Y == 4 && p.Z == -6, "a point");
    }

    public static int Main(string[] arguments)
    {
        byte[] file = File.ReadAllBytes(arguments[0]);
        Palettes model = new Palettes(arguments[1]);
        deepest = Deepest(file, model);
        AssetIsRead(file);
        CharacterRefuses(file, model);
        LayoutsAgree(file, model);
        BodyAgrees(file, model);
        TwoBodiesMeet(file, model);
        FramesAllocateNothing(file, model);
        ThreadsShareAnAsset(file, model);
        ACharacterIsOneThreads(file, model);
        DroppedObjectsAreFreed(file, model);
        MirrorsAreTheirOwnInverse();
        Console.WriteLine("{0} checks, {1} failures", checks, failures);
        return failures == 0 ? 0 : 1;
    }
}
